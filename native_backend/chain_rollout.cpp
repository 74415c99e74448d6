// Steps of one chain, and whole flights at as many gains as a number has lanes.

#include "chain_kernel.h"

#include <nuno/shape_control.h>

#include <algorithm>
#include <memory>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain_rollout.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once for every target
// clang-format off: it needs the target to be chosen
#include "chain_step-inl.h"
#include "grouped_control-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {

void step_scalar(const ChainPlan& plan, bool first, const double* forces, double* positions,
                 double* velocities, ScalarScratch& scratch) {
  static_assert(sizeof(Vec2<Real>) == 2 * sizeof(double) &&
                sizeof(Segment<Real>) == 4 * sizeof(double) &&
                sizeof(StiffSegment<Real>) == 12 * sizeof(double));
  double* values = scratch.values.data();
  const Scratch<Real> parts =
      plan.implicit_hinges
          ? Scratch<Real>{.stiff_segments = reinterpret_cast<StiffSegment<Real>*>(values)}
          : Scratch<Real>{.segments = reinterpret_cast<Segment<Real>*>(values)};
  advance<false>(plan, first, reinterpret_cast<Vec2<Real>*>(positions),
                 reinterpret_cast<Vec2<Real>*>(velocities), parts,
                 [forces](Index j, const Vec2<Real>&, const Vec2<Real>&) NUNO_INLINE_LAMBDA {
                   return Vec2<Real>{forces[2 * j], forces[2 * j + 1]};
                 });
}

/// Lanes of coordinate `at`: value to `finals`, derivative to `derivatives`, `stride` apart.
template <typename T>
HWY_INLINE void write_lanes(T number, double* finals, double*, Index at, Index stride,
                            Index count) {
  double values[HWY_MAX_BYTES / sizeof(double)] = {};
  store_lanes(number, values);
  for (Index lane = 0; lane < count; ++lane) finals[at + lane * stride] = values[lane];
}
template <typename T>
HWY_INLINE void write_lanes(Dual<T> number, double* finals, double* derivatives, Index at,
                            Index stride, Index count) {
  write_lanes(number.value, finals, nullptr, at, stride, count);
  write_lanes(number.derivative, derivatives, nullptr, at, stride, count);
}

/// What shape control is made of: springs, dashpots too, and both with gains by group.
enum class Control { springs, damped, grouped };

template <Control control, typename T>
void fly_lanes(const ChainPlan& plan, ReferenceMotion reference, const double* initial,
               const double* launch_velocity, const RolloutGains& gains, double* finals,
               double* derivatives) {
  constexpr bool damped_control = control != Control::springs;
  const Index n = plan.particles;
  const auto size = static_cast<std::size_t>(n);
  const std::unique_ptr<Vec2<T>[]> x(new Vec2<T>[size]);
  const std::unique_ptr<Vec2<T>[]> v(new Vec2<T>[size]);
  const OwnScratch<T> scratch(plan);
  const T zero = Constant<T>::of(0);
  Sums<T> sums{{zero, zero}, {zero, zero}};
  for (Index i = n; i-- > 0;) {
    x[i] = {Constant<T>::of(initial[2 * i]), Constant<T>::of(initial[2 * i + 1])};
    v[i] = {Constant<T>::of(launch_velocity[2 * i]), Constant<T>::of(launch_velocity[2 * i + 1])};
    sums.position = sums.position + x[i];
    sums.velocity = sums.velocity + v[i];
  }

  const GroupNumbers<T> rest = group_numbers<T>(plan, gains, gains.groups() - 1);
  const T gain = rest.gain, damping = rest.damping;
  LowModePull<T, Vec2<T>> low_modes;
  if constexpr (control == Control::grouped) low_modes.prepare(plan, gains);
  const T particles = Constant<T>::of(static_cast<double>(n));
  for (Index step = 0; step < plan.steps; ++step) {
    const double* shape = reference.shape().data();
    const double* motion = reference.velocity().data();
    const Vec2<T> center{divide(sums.position.x, particles), divide(sums.position.y, particles)};
    const Vec2<T> drift{divide(sums.velocity.x, particles), divide(sums.velocity.y, particles)};
    const auto offset = [&](Index j, const Vec2<T>& position) NUNO_INLINE_LAMBDA {
      return Vec2<T>{shift(shape[2 * j], center.x - position.x),
                     shift(shape[2 * j + 1], center.y - position.y)};
    };
    const auto lag = [&](Index j, const Vec2<T>& velocity) NUNO_INLINE_LAMBDA {
      return Vec2<T>{shift(motion[2 * j], drift.x - velocity.x),
                     shift(motion[2 * j + 1], drift.y - velocity.y)};
    };
    if constexpr (control == Control::grouped) {
      low_modes.project(
          n, {zero, zero}, [&](Index j) NUNO_INLINE_LAMBDA { return offset(j, x[j]); },
          [&](Index j) NUNO_INLINE_LAMBDA { return lag(j, v[j]); });
    }
    const auto control_force = [&](Index j, const Vec2<T>& position, const Vec2<T>& velocity)
                                   NUNO_INLINE_LAMBDA {
                                     Vec2<T> force = gain * offset(j, position);
                                     if constexpr (damped_control)
                                       force = force + damping * lag(j, velocity);
                                     if constexpr (control == Control::grouped)
                                       force = low_modes.add_to(force, j);
                                     return force;
                                   };
    sums =
        advance<damped_control>(plan, step == 0, x.get(), v.get(), scratch.parts(), control_force);
    reference.advance();
  }
  const Index count = gains.flights();
  for (Index i = 0; i < n; ++i) {
    write_lanes(x[i].x, finals, derivatives, 2 * i, 2 * n, count);
    write_lanes(x[i].y, finals, derivatives, 2 * i + 1, 2 * n, count);
  }
}

/// Gains by group take the damped path, whose dashpots may be nothing.
template <typename T>
auto flight_of(const ChainPlan& plan, const RolloutGains& gains) {
  if (gains.low_modes != nullptr) return fly_lanes<Control::grouped, T>;
  return plan.damping_ratio > 0 ? fly_lanes<Control::damped, T> : fly_lanes<Control::springs, T>;
}

void fly_all(const ChainPlan& plan, const ReferenceMotion& reference, const double* initial,
             const double* launch_velocity, const RolloutGains& gains, double* finals,
             double* derivatives) {
  const Index wide = lanes_of(Pack());
  const Index count = gains.flights();
  for (Index first = 0; first < count; first += wide) {
    const RolloutGains here = gains.part(first, std::min(wide, count - first));
    double* out = finals + first * 2 * plan.particles;
    double* out_derivatives =
        derivatives == nullptr ? nullptr : derivatives + first * 2 * plan.particles;
    const auto flight = derivatives != nullptr ? flight_of<Dual<Pack>>(plan, here)
                        : here.flights() == 1  ? flight_of<Real>(plan, here)
                                               : flight_of<Pack>(plan, here);
    flight(plan, reference, initial, launch_velocity, here, out, out_derivatives);
  }
}

Index lanes() { return lanes_of(Pack()); }
const char* instruction_set() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nuno::native {

HWY_EXPORT(step_scalar);
HWY_EXPORT(fly_all);
HWY_EXPORT(lanes);
HWY_EXPORT(instruction_set);

void step(const ChainPlan& plan, bool first, const double* forces, double* positions,
          double* velocities, ScalarScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(step_scalar)(plan, first, forces, positions, velocities, scratch);
}

void fly(const ChainPlan& plan, const ReferenceMotion& reference, const double* initial,
         const double* launch_velocity, const RolloutGains& gains, double* finals,
         double* derivatives) {
  HWY_DYNAMIC_DISPATCH(fly_all)
  (plan, reference, initial, launch_velocity, gains, finals, derivatives);
}

Index lanes() { return HWY_DYNAMIC_DISPATCH(lanes)(); }
std::string instruction_set() { return HWY_DYNAMIC_DISPATCH(instruction_set)(); }

}  // namespace nuno::native
#endif  // HWY_ONCE
