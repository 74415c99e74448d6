// A sheet's steps backwards (reverse mode).
//
// A step adds a linear map of small changes; its adjoint is the transpose. That of an elastic force
// is its own, as a second derivative of an energy: what a spring or a hinge adds to the cotangent
// of the positions is its force's derivative along the cotangent of the impulses. For a hinge that
// is a dual number of the same force. A dashpot's force F = −c·ȧ·∇a, a the length or angle, depends
// on two states, by ȧ = (a − a_before)/h: each gets its own share of ∇a.

#include "sheet_adjoint.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sheet_adjoint.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once for every target
// clang-format off: it needs the target to be chosen
#include "sheet_step-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {

#undef NUNO_INLINE_LAMBDA
#define NUNO_INLINE_LAMBDA __attribute__((always_inline)) HWY_ATTR

static_assert(sizeof(Vec3<Real>) == 3 * sizeof(double));

HWY_INLINE Vec3<Real>* vectors(std::vector<double>& values) {
  return reinterpret_cast<Vec3<Real>*>(values.data());
}
HWY_INLINE const Vec3<Real>* vectors(const std::vector<double>& values) {
  return reinterpret_cast<const Vec3<Real>*>(values.data());
}

HWY_INLINE SheetArrays<Real> arrays_of(SheetState& state) {
  return {vectors(state.positions), vectors(state.impulse), state.length.data(), state.turn.data(),
          state.velocities.empty() ? nullptr : vectors(state.velocities)};
}

void swing_all(const SheetPlan& plan, SheetState& state, SubstepTape* tape) {
  spring_substeps(plan, state.first, arrays_of(state), [&](Index n) {
    if (tape == nullptr) return;
    const auto keep = [n](const std::vector<double>& from, std::vector<double>& to) {
      std::ranges::copy(from, to.begin() + n * static_cast<Index>(from.size()));
    };
    keep(state.positions, tape->positions);
    keep(state.length, tape->length);
  });
  state.first = false;
}

/// A substep backwards. With û the cotangent of the impulses after the springs' kick,
///     û = r·ū' + h·q/m·x̄',
/// a spring of pull p on d adds ±(p·w + s·d) to x̄, w = ûᵢ − ûⱼ, where s·d is the share of the
/// length l in p, and in what it leaves for the next substep's dashpot (l̄').
template <bool damped>
HWY_INLINE void substep_back(const SheetPlan& plan, double share, const Vec3<Real>* x,
                             const double* length, Vec3<Real>* x_bar, Vec3<Real>* u_bar,
                             double* length_bar) {
  for (Index i = plan.particles; i-- > 0;) {
    const auto at = static_cast<std::size_t>(i);
    const Vec3<Real> u_hat = scale_add(plan.move[at], x_bar[i], scale(plan.keep, u_bar[i]));
    u_bar[i] = u_hat;
    Vec3<Real> sum = x_bar[i];
    for (auto e = static_cast<std::size_t>(plan.first_spring[at]);
         static_cast<Index>(e) < plan.first_spring[at + 1]; ++e) {
      const Index j = plan.far_end[e];
      const Vec3<Real> d = x[j] - x[i];
      const Vec3<Real> w = u_hat - u_bar[j];
      const Real squared = dot(d, d);
      const Real inverse = rsqrt(squared);
      const Real along = share * dot(w, d);  // what p gains by
      Real rest = plan.rest_tension[e];
      if constexpr (damped) rest = mul_add(plan.dashpot[e], length[e], rest);
      const Real slack = rest * inverse;
      const Real pull = share * (plan.spring[e] - slack);
      Real stretch = slack * along * (inverse * inverse);
      if constexpr (damped) {
        // l = d²·d⁻¹
        const Real unit = inverse * neg_mul_add(squared * inverse, inverse, 2.0);
        stretch = mul_add(length_bar[e], unit, stretch);
        length_bar[e] = -plan.dashpot[e] * inverse * along;
      }
      const Vec3<Real> change = add_scaled(stretch, d, pull * w);
      sum = sum - change;
      x_bar[j] = x_bar[j] + change;
    }
    x_bar[i] = sum;
  }
}

void swing_back_all(const SheetPlan& plan, bool first, const SubstepTape& tape,
                    SheetCotangent& cotangent) {
  const auto back = plan.dashpot.empty() ? substep_back<false> : substep_back<true>;
  const Index springs = static_cast<Index>(plan.dashpot.size());
  for (Index n = plan.substeps; n-- > 0;) {
    back(plan, n == 0 && first ? plan.first_share : 1, vectors(tape.positions) + n * plan.particles,
         tape.length.data() + n * springs, vectors(cotangent.positions), vectors(cotangent.impulse),
         cotangent.length.data());
  }
}

// ---- hinges, one a lane ---------------------------------------------------------------------

constexpr std::size_t most_lanes = HWY_MAX_BYTES / sizeof(double);

/// Values at one corner of as many hinges as a pack has lanes; those beyond the last repeat it.
HWY_INLINE Vec3<Pack> at_corner(const SheetPlan& plan, Index hinge, Index corner,
                                const Vec3<Real>* values) {
  double x[most_lanes], y[most_lanes], z[most_lanes];
  for (Index lane = 0; lane < lanes_of(Pack()); ++lane) {
    const Index h = std::min(hinge + lane, plan.hinges() - 1);
    const Vec3<Real>& value = values[plan.corners[static_cast<std::size_t>(4 * h + corner)]];
    x[lane] = value.x;
    y[lane] = value.y;
    z[lane] = value.z;
  }
  return {load_lanes(x, Pack()), load_lanes(y, Pack()), load_lanes(z, Pack())};
}

HWY_INLINE Pack of_hinges(const double* values, Index hinges, Index hinge) {
  double lanes[most_lanes];
  for (Index lane = 0; lane < lanes_of(Pack()); ++lane) {
    lanes[lane] = values[std::min(hinge + lane, hinges - 1)];
  }
  return load_lanes(lanes, Pack());
}
HWY_INLINE Pack of_hinges(const std::vector<double>& values, Index hinge) {
  return of_hinges(values.data(), static_cast<Index>(values.size()), hinge);
}

HWY_INLINE void write_hinges(Pack values, Index hinges, Index hinge, double* to) {
  double lanes[most_lanes];
  store_lanes(values, lanes);
  std::copy_n(lanes, std::min(lanes_of(Pack()), hinges - hinge), to + hinge);
}

HWY_INLINE Vec3<Dual<Pack>> along(const Vec3<Pack>& value, const Vec3<Pack>& direction) {
  return {{value.x, direction.x}, {value.y, direction.y}, {value.z, direction.z}};
}

HWY_INLINE Pack to_be_added(Pack force) { return force; }
HWY_INLINE Pack to_be_added(Dual<Pack> force) { return force.derivative; }

template <typename T>
HWY_INLINE HingeShape<T> shape_at(const SheetPlan& plan, Index hinge, const Vec3<T> (&corners)[4]) {
  return {corners[0],
          corners[1],
          corners[2],
          corners[3],
          of_hinges(plan.rest_cosine, hinge),
          of_hinges(plan.rest_sine, hinge)};
}

template <typename T>
HWY_INLINE void store_vectors(const Vec3<T>& vectors, double (&lanes)[3][most_lanes]) {
  store_lanes(to_be_added(vectors.x), lanes[0]);
  store_lanes(to_be_added(vectors.y), lanes[1]);
  store_lanes(to_be_added(vectors.z), lanes[2]);
}

/// Adds the forces that hinges of this shape and moment give, a hinge after another; of dual
/// numbers, their derivatives.
template <typename T>
HWY_INLINE void add_forces(const SheetPlan& plan, Index hinge, const HingeShape<T>& shape,
                           const T& moment, Vec3<Real>* to) {
  const HingeForces<T> on(shape, moment);
  double a[3][most_lanes], minus_b[3][most_lanes], c[3][most_lanes], d[3][most_lanes];
  store_vectors(on.a, a);
  store_vectors(on.minus_b, minus_b);
  store_vectors(on.c, c);
  store_vectors(on.d, d);
  const auto of_lane = [](const double(&values)[3][most_lanes], Index lane) NUNO_INLINE_LAMBDA {
    return Vec3<Real>{values[0][lane], values[1][lane], values[2][lane]};
  };
  const Index end = std::min(lanes_of(Pack()), plan.hinges() - hinge);
  const Index* corners = plan.corners.data() + 4 * hinge;
  for (Index lane = 0; lane < end; ++lane, corners += 4) {
    to[corners[0]] = to[corners[0]] + of_lane(a, lane);
    to[corners[1]] = to[corners[1]] - of_lane(minus_b, lane);
    to[corners[2]] = to[corners[2]] + of_lane(c, lane);
    to[corners[3]] = to[corners[3]] + of_lane(d, lane);
  }
}

HWY_INLINE HingeShape<Pack> shape_at(const SheetPlan& plan, Index hinge, const Vec3<Real>* x) {
  const Vec3<Pack> corners[4] = {at_corner(plan, hinge, 0, x), at_corner(plan, hinge, 1, x),
                                 at_corner(plan, hinge, 2, x), at_corner(plan, hinge, 3, x)};
  return shape_at(plan, hinge, corners);
}

/// What hinge_kick does, bit for bit.
void hinge_kick_in_packs(const SheetPlan& plan, double kicks, const SheetArrays<Real>& sheet) {
  for (Index h = 0; h < plan.hinges(); h += lanes_of(Pack())) {
    const HingeShape<Pack> shape = shape_at(plan, h, sheet.x);
    Pack moment = Pack(kicks) * of_hinges(plan.hinge_spring, h) * shape.turn;
    if (!plan.hinge_dashpot.empty()) {
      const Pack before = of_hinges(sheet.turn, plan.hinges(), h);
      moment = mul_add(Pack(kicks) * of_hinges(plan.hinge_dashpot, h),
                       within_half_turn(shape.turn - before), moment);
      write_hinges(shape.turn, plan.hinges(), h, sheet.turn);
    }
    add_forces(plan, h, shape, moment, sheet.u);
  }
}

void kick_all(const SheetPlan& plan, const double* forces, SheetState& state) {
  slow_kick(
      plan, state.first, arrays_of(state),
      [&](Index i) NUNO_INLINE_LAMBDA {
        const double* force = forces + 3 * plan.user_index[static_cast<std::size_t>(i)];
        return Vec3<Real>{force[0], force[1], force[2]};
      },
      hinge_kick_in_packs);
}

void turns_at_all(const SheetPlan& plan, const std::vector<double>& positions,
                  std::vector<double>& turn) {
  for (Index h = 0; h < plan.hinges(); h += lanes_of(Pack())) {
    write_hinges(shape_at(plan, h, vectors(positions)).turn, plan.hinges(), h, turn.data());
  }
}

/// The corners at x, moved along w.
HWY_INLINE HingeShape<Dual<Pack>> shape_along(const SheetPlan& plan, Index hinge,
                                              const Vec3<Real>* x, const Vec3<Real>* w) {
  const auto corner = [&](Index k) NUNO_INLINE_LAMBDA {
    return along(at_corner(plan, hinge, k, x), at_corner(plan, hinge, k, w));
  };
  const Vec3<Dual<Pack>> corners[4] = {corner(0), corner(1), corner(2), corner(3)};
  return shape_at(plan, hinge, corners);
}

template <bool damped>
void hinges_back(const SheetPlan& plan, bool first, const std::vector<double>& positions,
                 const std::vector<double>& turn, SheetCotangent& cotangent) {
  const Pack kicks(kicks_of_step(plan, first));
  for (Index h = 0; h < plan.hinges(); h += lanes_of(Pack())) {
    const HingeShape<Dual<Pack>> shape =
        shape_along(plan, h, vectors(positions), vectors(cotangent.impulse));
    const Dual<Pack>& angle = shape.turn;
    Dual<Pack> moment = scale(kicks * of_hinges(plan.hinge_spring, h), angle);
    if constexpr (damped) {
      const Pack dashpot = kicks * of_hinges(plan.hinge_dashpot, h);
      const Pack before = of_hinges(turn, h), turn_bar = of_hinges(cotangent.turn, h);
      const Pack by_angle = dashpot * angle.derivative;
      moment.value = mul_add(dashpot, within_half_turn(angle.value - before), moment.value);
      moment.derivative = moment.derivative + by_angle - turn_bar;
      write_hinges(by_angle, plan.hinges(), h, cotangent.turn.data());
    }
    add_forces(plan, h, shape, moment, vectors(cotangent.positions));
  }
}

void kick_back_all(const SheetPlan& plan, bool first, const std::vector<double>& positions,
                   const std::vector<double>& turn, SheetCotangent& cotangent) {
  const auto back = plan.hinge_dashpot.empty() ? hinges_back<false> : hinges_back<true>;
  back(plan, first, positions, turn, cotangent);
}

/// `begin` puts turns a step back, θ − H·∇θ·v: what they gain is a moment's force.
void begin_turns_back(const SheetPlan& plan, const std::vector<double>& positions,
                      const SheetCotangent& cotangent, std::vector<double>& velocities) {
  for (Index h = 0; h < plan.hinges(); h += lanes_of(Pack())) {
    const Pack moment = Pack(plan.time_step) * of_hinges(cotangent.turn, h);
    add_forces(plan, h, shape_at(plan, h, vectors(positions)), moment, vectors(velocities));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nuno::native {

HWY_EXPORT(kick_all);
HWY_EXPORT(swing_all);
HWY_EXPORT(swing_back_all);
HWY_EXPORT(kick_back_all);
HWY_EXPORT(turns_at_all);
HWY_EXPORT(begin_turns_back);

void kick(const SheetPlan& plan, const Points& forces, SheetState& state) {
  HWY_DYNAMIC_DISPATCH(kick_all)(plan, forces.data(), state);
}

void swing(const SheetPlan& plan, SheetState& state, SubstepTape* tape) {
  if (tape != nullptr) {
    const auto substeps = static_cast<std::size_t>(plan.substeps);
    tape->positions.resize(substeps * state.positions.size());
    tape->length.resize(substeps * state.length.size());
  }
  HWY_DYNAMIC_DISPATCH(swing_all)(plan, state, tape);
}

void swing_back(const SheetPlan& plan, bool first, const SubstepTape& tape,
                SheetCotangent& cotangent) {
  HWY_DYNAMIC_DISPATCH(swing_back_all)(plan, first, tape, cotangent);
}

void kick_back(const SheetPlan& plan, bool first, const std::vector<double>& positions,
               const std::vector<double>& turn, SheetCotangent& cotangent) {
  HWY_DYNAMIC_DISPATCH(kick_back_all)(plan, first, positions, turn, cotangent);
}

void turns_at(const SheetPlan& plan, const std::vector<double>& positions,
              std::vector<double>& turn) {
  HWY_DYNAMIC_DISPATCH(turns_at_all)(plan, positions, turn);
}

void begin_back(const SheetPlan& plan, const std::vector<double>& positions,
                const SheetCotangent& cotangent, std::vector<double>& velocities) {
  using Vectors = Eigen::Map<Points>;
  const Vectors v(velocities.data(), 3, plan.particles);
  // ū is of u = (m/q)·r·v − …, and the plan has h·q/m.
  const Eigen::Map<const Points> u(cotangent.impulse.data(), 3, plan.particles);
  const Eigen::Map<const Points> x(positions.data(), 3, plan.particles);
  Vectors sum = v;
  for (Index i = 0; i < plan.particles; ++i) {
    const auto at = static_cast<std::size_t>(i);
    sum.col(i) += plan.substep * plan.first_keep / plan.move[at] * u.col(i);
    if (cotangent.length.empty()) continue;
    for (Index e = plan.first_spring[at]; e < plan.first_spring[at + 1]; ++e) {
      // Lengths are a substep back, l − h·l̇.
      const auto spring = static_cast<std::size_t>(e);
      const Index j = plan.far_end[spring];
      const Vector change =
          plan.substep * cotangent.length[spring] * (x.col(j) - x.col(i)).normalized();
      sum.col(i) += change;
      sum.col(j) -= change;
    }
  }
  if (!cotangent.turn.empty()) {
    HWY_DYNAMIC_DISPATCH(begin_turns_back)(plan, positions, cotangent, velocities);
  }
}

}  // namespace nuno::native
#endif  // HWY_ONCE
