// What the kernels of chain and sheet share of shape control: gains by group of modes, in lanes.

#if defined(NUNO_GROUPED_CONTROL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NUNO_GROUPED_CONTROL_INL_H_
#undef NUNO_GROUPED_CONTROL_INL_H_
#else
#define NUNO_GROUPED_CONTROL_INL_H_
#endif

#include <nuno/shape_control.h>

#include "rollout_gains.h"

#include <algorithm>

#include <hwy/highway.h>
#include "number-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {

// Numbers of a gain in every lane; `seeds` is 1 where the derivative is with respect to it, 0
// elsewhere.
HWY_INLINE Real gain_number(const double* gains, const double*, Real) { return *gains; }
HWY_INLINE Pack gain_number(const double* gains, const double*, Pack) {
  return load_lanes(gains, Pack());
}
template <typename T>
HWY_INLINE Dual<T> gain_number(const double* gains, const double* seeds, Dual<T>) {
  return {load_lanes(gains, T()), load_lanes(seeds, T())};
}

/// β = 2ζ·√(α·m), shape_damping of the core; its derivative is β/2α.
HWY_INLINE Real damping_number(const double* gains, const double*, double ratio, double mass,
                               Real) {
  return shape_damping(ratio, *gains, mass);
}
HWY_INLINE Pack damping_number(const double* gains, const double*, double ratio, double mass,
                               Pack) {
  double damping[HWY_MAX_BYTES / sizeof(double)] = {};
  for (Index lane = 0; lane < lanes_of(Pack()); ++lane) {
    damping[lane] = shape_damping(ratio, gains[lane], mass);
  }
  return load_lanes(damping, Pack());
}
template <typename T>
HWY_INLINE Dual<T> damping_number(const double* gains, const double* seeds, double ratio,
                                  double mass, Dual<T>) {
  const T damping = damping_number(gains, seeds, ratio, mass, T());
  const T gain = load_lanes(gains, T());
  // At α = 0 the derivative is infinite; there it is given as none.
  const T derivative = where_greater(gain, T(0.0), T(0.5) * damping / gain, T(0.0));
  return {damping, load_lanes(seeds, T()) * derivative};
}

/// What one group of modes is pulled with.
template <typename T>
struct GroupNumbers {
  T gain, damping;
};
/// Of a plan of either kernel.
template <typename T, typename Plan>
HWY_INLINE GroupNumbers<T> group_numbers(const Plan& plan, const RolloutGains& gains, Index group) {
  double values[HWY_MAX_BYTES / sizeof(double)] = {};
  double seeds[HWY_MAX_BYTES / sizeof(double)] = {};
  for (Index lane = 0; lane < lanes_of(T()); ++lane) {
    const Index flight = std::min(lane, gains.flights() - 1);
    values[lane] = gains.value(flight, group);
    seeds[lane] = gains.seed(flight) == group ? 1 : 0;
  }
  return {gain_number(values, seeds, T()),
          damping_number(values, seeds, plan.damping_ratio, plan.particle_mass, T())};
}

/// The part of shape control by which the low modes' gains differ from the last group's, on vectors
/// V of numbers T.
template <typename T, typename V>
struct LowModePull {
  Index count = 0;                 ///< 0 where there is but one group
  const double* shapes = nullptr;  ///< [modes × N]
  GroupNumbers<T> excess[most_low_modes];
  V amplitude[most_low_modes];  ///< of the force on each mode

  template <typename Plan>
  HWY_INLINE void prepare(const Plan& plan, const RolloutGains& gains) {
    if (gains.low_modes == nullptr) return;
    const GroupNumbers<T> rest = group_numbers<T>(plan, gains, gains.groups() - 1);
    count = gains.low_modes->count();
    shapes = gains.low_modes->shapes.data();
    for (Index j = 0; j < count; ++j) {
      const Index group = gains.low_modes->group[static_cast<std::size_t>(j)];
      const GroupNumbers<T> own = group_numbers<T>(plan, gains, group);
      excess[j] = {own.gain - rest.gain, own.damping - rest.damping};
    }
  }

  /// Projects what is missing of shape and velocity, `offset(i)` and `lag(i)` at particle i, times
  /// its relative mass.
  template <typename Offset, typename Lag>
  HWY_INLINE void project(Index particles, const V& zero, Offset&& offset, Lag&& lag) {
    V spring[most_low_modes], dashpot[most_low_modes];
    for (Index j = 0; j < count; ++j) spring[j] = dashpot[j] = zero;
    for (Index i = 0; i < particles; ++i) {
      const V o = offset(i);
      const V u = lag(i);
      for (Index j = 0; j < count; ++j) {
        const double weight = shapes[i * count + j];
        spring[j] = spring[j] + scale(weight, o);
        dashpot[j] = dashpot[j] + scale(weight, u);
      }
    }
    for (Index j = 0; j < count; ++j) {
      amplitude[j] = excess[j].gain * spring[j] + excess[j].damping * dashpot[j];
    }
  }

  HWY_INLINE V add_to(V force, Index i) const {
    for (Index j = 0; j < count; ++j) force = force + scale(shapes[i * count + j], amplitude[j]);
    return force;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
