// Steps of one sheet, and whole flights at as many gains as a number has lanes.

#include "sheet_kernel.h"

#include <nuno/shape_control.h>

#include <algorithm>
#include <memory>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sheet_rollout.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once for every target
// clang-format off: it needs the target to be chosen
#include "grouped_control-inl.h"
#include "sheet_step-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {

#undef NUNO_INLINE_LAMBDA
#define NUNO_INLINE_LAMBDA __attribute__((always_inline)) HWY_ATTR

void step_sheet(const SheetPlan& plan, const double* forces, SheetState& state) {
  static_assert(sizeof(Vec3<Real>) == 3 * sizeof(double));
  const SheetArrays<Real> sheet{reinterpret_cast<Vec3<Real>*>(state.positions.data()),
                                reinterpret_cast<Vec3<Real>*>(state.impulse.data()),
                                state.length.data(), state.turn.data(),
                                reinterpret_cast<Vec3<Real>*>(state.velocities.data())};
  advance_sheet(plan, state.first, sheet, [&](Index i) NUNO_INLINE_LAMBDA {
    const double* force = forces + 3 * plan.user_index[static_cast<std::size_t>(i)];
    return Vec3<Real>{force[0], force[1], force[2]};
  });
  state.first = false;
}

/// θ − θ₀ of every hinge, a step before `state` at these rates of the particles [3 × N].
void begin_turns(const SheetPlan& plan, const double* rates, SheetState& state) {
  const auto* x = reinterpret_cast<const Vec3<Real>*>(state.positions.data());
  const auto* v = reinterpret_cast<const Vec3<Real>*>(rates);
  for (std::size_t h = 0; h < state.turn.size(); ++h) {
    const Index* corners = plan.corners.data() + 4 * h;
    const Index a = corners[0], b = corners[1], c = corners[2], d = corners[3];
    const HingeShape<Real> shape(x[a], x[b], x[c], x[d], plan.rest_cosine[h], plan.rest_sine[h]);
    // Velocities over the line through a and b, where the feet of c and d are.
    const Vec3<Real> along = v[b] - v[a];
    const Real one = dot(shape.n1, subtract_scaled(shape.t1, along, v[c] - v[a]));
    const Real two = dot(shape.n2, subtract_scaled(shape.t2, along, v[d] - v[a]));
    state.turn[h] = shape.turn + plan.time_step * (shape.g1 * one + shape.g2 * two);
  }
}

// ---- flights at a gain in every lane --------------------------------------------------------

template <typename T>
HWY_INLINE void write_sheet_lanes(T number, double* values, double*, Index stride, Index count) {
  double lanes[HWY_MAX_BYTES / sizeof(double)] = {};
  store_lanes(number, lanes);
  for (Index lane = 0; lane < count; ++lane) values[lane * stride] = lanes[lane];
}
template <typename T>
HWY_INLINE void write_sheet_lanes(Dual<T> number, double* values, double* derivatives, Index stride,
                                  Index count) {
  write_sheet_lanes(number.value, values, nullptr, stride, count);
  write_sheet_lanes(number.derivative, derivatives, nullptr, stride, count);
}

/// Σ mᵢ·xᵢ/Σ mᵢ, summed as mass_center of the core does.
template <typename T>
HWY_INLINE Vec3<T> sheet_center(const SheetPlan& plan, const Vec3<T>* x) {
  Vec3<T> sum{Constant<T>::of(0), Constant<T>::of(0), Constant<T>::of(0)};
  for (std::size_t i = plan.relative_mass.size(); i-- > 0;) {
    sum = sum + scale(plan.relative_mass[i], x[plan.plan_index[i]]);
  }
  const T particles = Constant<T>::of(static_cast<double>(plan.particles));
  return {divide(sum.x, particles), divide(sum.y, particles), divide(sum.z, particles)};
}

template <bool damped_control, typename T>
void fly_sheet_lanes(const SheetPlan& plan, ReferenceMotion reference, const SheetState& start,
                     const RolloutGains& gains, double* finals, double* derivatives) {
  const Index n = plan.particles;
  const auto broadcast = [](const std::vector<double>& from) NUNO_INLINE_LAMBDA {
    std::unique_ptr<T[]> to(new T[from.size()]);
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = Constant<T>::of(from[i]);
    return to;
  };
  const std::unique_ptr<T[]> positions = broadcast(start.positions);
  const std::unique_ptr<T[]> impulse = broadcast(start.impulse);
  const std::unique_ptr<T[]> length = broadcast(start.length);
  const std::unique_ptr<T[]> turn = broadcast(start.turn);
  static_assert(sizeof(Vec3<T>) == 3 * sizeof(T));
  const std::unique_ptr<T[]> velocities = broadcast(start.velocities);
  auto* velocity = damped_control ? reinterpret_cast<Vec3<T>*>(velocities.get()) : nullptr;
  const SheetArrays<T> sheet{reinterpret_cast<Vec3<T>*>(positions.get()),
                             reinterpret_cast<Vec3<T>*>(impulse.get()), length.get(), turn.get(),
                             velocity};
  const GroupNumbers<T> control = group_numbers<T>(plan, gains, gains.groups() - 1);
  LowModePull<T, Vec3<T>> low_modes;
  low_modes.prepare(plan, gains);
  // As the core's rollout does, velocities are taken on by half a step, with the reference's.
  const std::unique_ptr<T[]> told = broadcast(start.velocities);
  const std::unique_ptr<T[]> before = broadcast(start.velocities);
  auto* told_velocity = damped_control ? reinterpret_cast<Vec3<T>*>(told.get()) : nullptr;
  auto* velocity_before = damped_control ? reinterpret_cast<Vec3<T>*>(before.get()) : nullptr;
  Points motion_before = reference.velocity();
  const T zero = Constant<T>::of(0);
  const Vec3<T> none{zero, zero, zero};
  for (Index step = 0; step < plan.steps; ++step) {
    const double* shape = reference.shape().data();
    const double* motion = reference.velocity().data();
    const Vec3<T> center = sheet_center(plan, sheet.x);
    Vec3<T> drift = center;
    if constexpr (damped_control) {
      for (Index i = 0; i < n; ++i) {
        const Index user = 3 * plan.user_index[static_cast<std::size_t>(i)];
        const double* then = motion_before.data() + user;
        const double* now = motion + user;
        const Vec3<T> change = velocity[i] - velocity_before[i];
        told_velocity[i] = velocity[i] + scale(0.5, Vec3<T>{shift(then[0] - now[0], change.x),
                                                            shift(then[1] - now[1], change.y),
                                                            shift(then[2] - now[2], change.z)});
        velocity_before[i] = velocity[i];
      }
      motion_before = reference.velocity();
      drift = sheet_center(plan, told_velocity);
    }
    // Of a particle by its index in the problem.
    const auto missing = [&](const double* of, const Vec3<T>& mean, const Vec3<T>* here,
                             Index user) NUNO_INLINE_LAMBDA {
      const double* at = of + 3 * user;
      const Vec3<T>& own = here[plan.plan_index[static_cast<std::size_t>(user)]];
      return Vec3<T>{shift(at[0], mean.x - own.x), shift(at[1], mean.y - own.y),
                     shift(at[2], mean.z - own.z)};
    };
    const auto offset = [&](Index user)
                            NUNO_INLINE_LAMBDA { return missing(shape, center, sheet.x, user); };
    const auto lag = [&](Index user) NUNO_INLINE_LAMBDA {
      if constexpr (damped_control) return missing(motion, drift, told_velocity, user);
      return none;
    };
    const auto mass = [&](Index user) NUNO_INLINE_LAMBDA {
      return plan.relative_mass[static_cast<std::size_t>(user)];
    };
    if (low_modes.count > 0) {
      low_modes.project(
          n, none, [&](Index user) NUNO_INLINE_LAMBDA { return scale(mass(user), offset(user)); },
          [&](Index user) NUNO_INLINE_LAMBDA { return scale(mass(user), lag(user)); });
    }
    advance_sheet(plan, step == 0, sheet, [&](Index i) NUNO_INLINE_LAMBDA {
      const Index user = plan.user_index[static_cast<std::size_t>(i)];
      Vec3<T> pull = control.gain * offset(user);
      if constexpr (damped_control) pull = pull + control.damping * lag(user);
      return scale(mass(user), low_modes.add_to(pull, user));
    });
    reference.advance();
  }
  const Index count = gains.flights();
  for (Index i = 0; i < n; ++i) {
    const Index at = 3 * plan.user_index[static_cast<std::size_t>(i)];
    const T coordinates[3] = {sheet.x[i].x, sheet.x[i].y, sheet.x[i].z};
    for (Index row = 0; row < 3; ++row) {
      write_sheet_lanes(coordinates[row], finals + at + row,
                        derivatives == nullptr ? nullptr : derivatives + at + row, 3 * n, count);
    }
  }
}

template <typename T>
auto sheet_flight_of(const SheetPlan& plan) {
  return plan.damping_ratio > 0 ? fly_sheet_lanes<true, T> : fly_sheet_lanes<false, T>;
}

void fly_sheet_all(const SheetPlan& plan, const ReferenceMotion& reference, const SheetState& start,
                   const RolloutGains& gains, double* finals, double* derivatives) {
  const Index wide = lanes_of(Pack()), stride = 3 * plan.particles;
  for (Index first = 0; first < gains.flights(); first += wide) {
    const RolloutGains here = gains.part(first, std::min(wide, gains.flights() - first));
    const auto flight = derivatives != nullptr ? sheet_flight_of<Dual<Pack>>(plan)
                        : here.flights() == 1  ? sheet_flight_of<Real>(plan)
                                               : sheet_flight_of<Pack>(plan);
    flight(plan, reference, start, here, finals + first * stride,
           derivatives == nullptr ? nullptr : derivatives + first * stride);
  }
}

Index sheet_lanes() { return lanes_of(Pack()); }

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nuno::native {

HWY_EXPORT(step_sheet);
HWY_EXPORT(begin_turns);
HWY_EXPORT(fly_sheet_all);
HWY_EXPORT(sheet_lanes);

SheetState begin(const SheetPlan& plan, const Points& positions, const Points& velocities) {
  const auto n = static_cast<std::size_t>(plan.particles);
  SheetState state;
  state.positions.resize(3 * n);
  state.impulse.resize(3 * n);
  std::vector<double> rates(3 * n);  // of the particles
  for (std::size_t i = 0; i < n; ++i) {
    const Index user = plan.user_index[i];
    const double mass =
        plan.particle_mass * plan.relative_mass[static_cast<std::size_t>(user)] / plan.kick_time;
    for (std::size_t row = 0; row < 3; ++row) {
      state.positions[3 * i + row] = positions(static_cast<Index>(row), user);
      rates[3 * i + row] = velocities(static_cast<Index>(row), user);
      state.impulse[3 * i + row] = mass * plan.first_keep * rates[3 * i + row];
    }
    state.impulse[3 * i + 1] -= plan.first_share * plan.weight[i];
  }
  state.velocities = rates;
  if (!plan.dashpot.empty()) {
    const auto at = [](const std::vector<double>& values, std::size_t i) {
      return Eigen::Map<const Eigen::Vector3d>(values.data() + 3 * i);
    };
    state.length.resize(plan.spring.size());
    for (std::size_t i = 0, e = 0; i < n; ++i) {
      for (; static_cast<Index>(e) < plan.first_spring[i + 1]; ++e) {
        const auto j = static_cast<std::size_t>(plan.far_end[e]);
        const Eigen::Vector3d span = at(state.positions, j) - at(state.positions, i);
        const double length = span.norm();
        const double rate = span.dot(at(rates, j) - at(rates, i)) / length;
        state.length[e] = length - plan.substep * rate;
      }
    }
  }
  if (!plan.hinge_dashpot.empty()) {
    state.turn.resize(plan.hinge_spring.size());
    HWY_DYNAMIC_DISPATCH(begin_turns)(plan, rates.data(), state);
  }
  return state;
}

void step(const SheetPlan& plan, const Points& forces, SheetState& state) {
  HWY_DYNAMIC_DISPATCH(step_sheet)(plan, forces.data(), state);
}

void in_user_order(const SheetPlan& plan, const std::vector<double>& values, Points& points) {
  points.resize(3, plan.particles);
  for (Index i = 0; i < plan.particles; ++i) {
    points.col(plan.user_index[static_cast<std::size_t>(i)]) =
        Eigen::Map<const Eigen::Vector3d>(values.data() + 3 * i);
  }
}

void fly(const SheetPlan& plan, const ReferenceMotion& reference, const SheetState& start,
         const RolloutGains& gains, double* finals, double* derivatives) {
  HWY_DYNAMIC_DISPATCH(fly_sheet_all)
  (plan, reference, start, gains, finals, derivatives);
}

Index sheet_lanes() { return HWY_DYNAMIC_DISPATCH(sheet_lanes)(); }

}  // namespace nuno::native
#endif  // HWY_ONCE
