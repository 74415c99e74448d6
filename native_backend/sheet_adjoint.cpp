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

void kick_all(const SheetPlan& plan, const double* forces, SheetState& state) {
  slow_kick(plan, state.first, arrays_of(state), [&](Index i) NUNO_INLINE_LAMBDA {
    const double* force = forces + 3 * plan.user_index[static_cast<std::size_t>(i)];
    return Vec3<Real>{force[0], force[1], force[2]};
  });
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

/// Values at one corner of as many hinges as a pack has lanes; those beyond the last repeat it.
HWY_INLINE Vec3<Pack> at_corner(const SheetPlan& plan, Index hinge, Index corner,
                                const Vec3<Real>* values) {
  constexpr std::size_t most = HWY_MAX_BYTES / sizeof(double);
  double x[most], y[most], z[most];
  for (Index lane = 0; lane < lanes_of(Pack()); ++lane) {
    const Index h = std::min(hinge + lane, plan.hinges() - 1);
    const Vec3<Real>& value = values[plan.corners[static_cast<std::size_t>(4 * h + corner)]];
    x[lane] = value.x;
    y[lane] = value.y;
    z[lane] = value.z;
  }
  return {load_lanes(x, Pack()), load_lanes(y, Pack()), load_lanes(z, Pack())};
}

HWY_INLINE Pack of_hinges(const std::vector<double>& values, Index hinge) {
  double lanes[HWY_MAX_BYTES / sizeof(double)];
  for (Index lane = 0; lane < lanes_of(Pack()); ++lane) {
    lanes[lane] = values[std::min(static_cast<std::size_t>(hinge + lane), values.size() - 1)];
  }
  return load_lanes(lanes, Pack());
}

HWY_INLINE Vec3<Dual<Pack>> along(const Vec3<Pack>& value, const Vec3<Pack>& direction) {
  return {{value.x, direction.x}, {value.y, direction.y}, {value.z, direction.z}};
}

HWY_INLINE void add_at_corner(const SheetPlan& plan, Index hinge, Index corner,
                              const Vec3<Dual<Pack>>& change, double sign, Vec3<Real>* to) {
  constexpr std::size_t most = HWY_MAX_BYTES / sizeof(double);
  double x[most], y[most], z[most];
  store_lanes(change.x.derivative, x);
  store_lanes(change.y.derivative, y);
  store_lanes(change.z.derivative, z);
  const Index end = std::min(lanes_of(Pack()), plan.hinges() - hinge);
  for (Index lane = 0; lane < end; ++lane) {
    Vec3<Real>& sum = to[plan.corners[static_cast<std::size_t>(4 * (hinge + lane) + corner)]];
    sum = sum + sign * Vec3<Real>{x[lane], y[lane], z[lane]};
  }
}

HWY_INLINE void write_hinges(Pack values, Index hinge, std::vector<double>& to) {
  double lanes[HWY_MAX_BYTES / sizeof(double)];
  store_lanes(values, lanes);
  const auto first = static_cast<std::size_t>(hinge);
  const std::size_t count = std::min(static_cast<std::size_t>(lanes_of(Pack())), to.size() - first);
  std::copy_n(lanes, count, to.begin() + hinge);
}

template <typename T>
HWY_INLINE HingeShape<T> shape_at(const SheetPlan& plan, Index hinge, const Vec3<T> (&corners)[4]) {
  return {corners[0],
          corners[1],
          corners[2],
          corners[3],
          of_hinges(plan.rest_cosine, hinge),
          of_hinges(plan.rest_sine, hinge)};
}

void turns_at_all(const SheetPlan& plan, const std::vector<double>& positions,
                  std::vector<double>& turn) {
  const Vec3<Real>* x = vectors(positions);
  for (Index h = 0; h < plan.hinges(); h += lanes_of(Pack())) {
    const Vec3<Pack> corners[4] = {at_corner(plan, h, 0, x), at_corner(plan, h, 1, x),
                                   at_corner(plan, h, 2, x), at_corner(plan, h, 3, x)};
    write_hinges(shape_at(plan, h, corners).turn, h, turn);
  }
}

/// The corners at x, moved along w, and the hinges' forces there.
struct HingesAlong {
  HingeShape<Dual<Pack>> shape;

  HWY_INLINE HingesAlong(const SheetPlan& plan, Index hinge, const Vec3<Real>* x,
                         const Vec3<Real>* w)
      : shape(shape_of(plan, hinge, x, w)) {}

  static HWY_INLINE HingeShape<Dual<Pack>> shape_of(const SheetPlan& plan, Index hinge,
                                                    const Vec3<Real>* x, const Vec3<Real>* w) {
    const auto corner = [&](Index k) NUNO_INLINE_LAMBDA {
      return along(at_corner(plan, hinge, k, x), at_corner(plan, hinge, k, w));
    };
    const Vec3<Dual<Pack>> corners[4] = {corner(0), corner(1), corner(2), corner(3)};
    return shape_at(plan, hinge, corners);
  }
};

/// Adds the derivatives of the forces that hinges of this shape and moment give.
HWY_INLINE void add_forces(const SheetPlan& plan, Index hinge, const HingeShape<Dual<Pack>>& shape,
                           const Dual<Pack>& moment, Vec3<Real>* to) {
  const HingeForces<Dual<Pack>> on(shape, moment);
  add_at_corner(plan, hinge, 0, on.a, 1, to);
  add_at_corner(plan, hinge, 1, on.minus_b, -1, to);
  add_at_corner(plan, hinge, 2, on.c, 1, to);
  add_at_corner(plan, hinge, 3, on.d, 1, to);
}

template <bool damped>
void hinges_back(const SheetPlan& plan, bool first, const std::vector<double>& positions,
                 const std::vector<double>& turn, SheetCotangent& cotangent) {
  const Pack kicks(kicks_of_step(plan, first));
  for (Index h = 0; h < plan.hinges(); h += lanes_of(Pack())) {
    const HingesAlong hinges(plan, h, vectors(positions), vectors(cotangent.impulse));
    const Dual<Pack>& angle = hinges.shape.turn;
    Dual<Pack> moment = scale(kicks * of_hinges(plan.hinge_spring, h), angle);
    if constexpr (damped) {
      const Pack dashpot = kicks * of_hinges(plan.hinge_dashpot, h);
      const Pack before = of_hinges(turn, h), turn_bar = of_hinges(cotangent.turn, h);
      const Pack by_angle = dashpot * angle.derivative;
      moment.value = mul_add(dashpot, within_half_turn(angle.value - before), moment.value);
      moment.derivative = moment.derivative + by_angle - turn_bar;
      write_hinges(by_angle, h, cotangent.turn);
    }
    add_forces(plan, h, hinges.shape, moment, vectors(cotangent.positions));
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
  const std::vector<double> none(positions.size(), 0.0);
  for (Index h = 0; h < plan.hinges(); h += lanes_of(Pack())) {
    const HingesAlong hinges(plan, h, vectors(positions), vectors(none));
    const Pack moment = Pack(plan.time_step) * of_hinges(cotangent.turn, h);
    add_forces(plan, h, hinges.shape, {Pack(0.0), moment}, vectors(velocities));
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
