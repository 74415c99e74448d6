// Derivatives of a flight along as many directions as a pair of packs has lanes.

#include "chain_kernel.h"

#include <nuno/shape_control.h>

#include <algorithm>
#include <cassert>
#include <memory>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain_jacobian.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once for every target
// clang-format off: it needs the target to be chosen
#include "chain_step-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {

using Derivatives = Pair<Pack>;
constexpr std::size_t most_derivatives = std::size_t{2} * HWY_MAX_BYTES / sizeof(double);

/// The number whose value is the same in every lane and whose derivatives differ.
HWY_INLINE Dual<Pack, Derivatives> with_derivatives(double value, Derivatives derivatives) {
  return {Pack(value), derivatives};
}

template <bool damped_control>
void fly_along_lanes(const ChainPlan& plan, const RolloutState& start, double gain,
                     const Directions& directions, std::span<const Index> samples,
                     const DirectionalDerivatives& derivatives) {
  using T = Dual<Pack, Derivatives>;
  const Index n = plan.particles;
  const auto size = static_cast<std::size_t>(n);
  const std::unique_ptr<Vec2<T>[]> x(new Vec2<T>[size]);
  const std::unique_ptr<Vec2<T>[]> v(new Vec2<T>[size]);
  const std::unique_ptr<Vec2<Derivatives>[]> correction(new Vec2<Derivatives>[size]);
  const OwnScratch<T> scratch(plan);
  // A value of each direction, a direction a lane.
  const auto across = [&](auto value_of) NUNO_INLINE_LAMBDA {
    double values[most_derivatives] = {};
    for (Index lane = 0; lane < directions.count; ++lane) values[lane] = value_of(lane);
    return load_lanes(values, Derivatives());
  };
  const auto coordinate = [&](const double* shapes, Index at) NUNO_INLINE_LAMBDA {
    return across([=](Index lane) NUNO_INLINE_LAMBDA { return shapes[lane * 2 * n + at]; });
  };
  const auto of_power = [&](const CorrectionShares& shares) NUNO_INLINE_LAMBDA {
    return across([&](Index lane) NUNO_INLINE_LAMBDA {
      return shares[static_cast<std::size_t>(directions.powers[lane])];
    });
  };
  const auto keep = [&](Derivatives values_of, double* to, Index stride) NUNO_INLINE_LAMBDA {
    double values[most_derivatives];
    store_lanes(values_of, values);
    for (Index lane = 0; lane < directions.count; ++lane) to[lane * stride] = values[lane];
  };
  const T zero = Constant<T>::of(0);
  Sums<T> sums{{zero, zero}, {zero, zero}};
  for (Index i = n; i-- > 0;) {
    correction[i] = {coordinate(directions.shapes, 2 * i),
                     coordinate(directions.shapes, 2 * i + 1)};
    x[i] = {Constant<T>::of(start.positions(0, i)), Constant<T>::of(start.positions(1, i))};
    v[i] = {with_derivatives(start.velocities(0, i), coordinate(directions.launches, 2 * i)),
            with_derivatives(start.velocities(1, i), coordinate(directions.launches, 2 * i + 1))};
    sums.position = sums.position + x[i];
    sums.velocity = sums.velocity + v[i];
  }

  const double damping = shape_damping(plan.damping_ratio, gain, plan.particle_mass);
  const T particles = Constant<T>::of(static_cast<double>(n));
  const auto sampled = static_cast<Index>(samples.size());
  Index sample = std::ranges::lower_bound(samples, start.step) - samples.begin();
  ReferenceMotion reference = start.reference;
  for (Index step = start.step; step < plan.steps; ++step) {
    const double* shape = reference.shape().data();
    const double* motion = reference.velocity().data();
    const Derivatives share = of_power(reference.correction_shares());
    const Derivatives rate = of_power(reference.correction_rates());
    const bool keeps = sample < sampled && samples[static_cast<std::size_t>(sample)] == step;
    const Vec2<T> center{divide(sums.position.x, particles), divide(sums.position.y, particles)};
    const Vec2<T> drift{divide(sums.velocity.x, particles), divide(sums.velocity.y, particles)};
    sums = advance<damped_control>(
        plan, step == 0, x.get(), v.get(), scratch.parts(),
        [&](Index j, const Vec2<T>& position, const Vec2<T>& velocity) NUNO_INLINE_LAMBDA {
          const Vec2<T> place{with_derivatives(shape[2 * j], share * correction[j].x),
                              with_derivatives(shape[2 * j + 1], share * correction[j].y)};
          const Vec2<T> residual = place + (center - position);
          Vec2<T> force{scale(gain, residual.x), scale(gain, residual.y)};
          if constexpr (damped_control) {
            const Vec2<T> speed{with_derivatives(motion[2 * j], rate * correction[j].x),
                                with_derivatives(motion[2 * j + 1], rate * correction[j].y)};
            const Vec2<T> lag = speed + (drift - velocity);
            force = force + Vec2<T>{scale(damping, lag.x), scale(damping, lag.y)};
          }
          if (keeps) {
            double* forces = derivatives.forces + 2 * (sample * n + j);
            keep(force.x.derivative, forces, 2 * n * sampled);
            keep(force.y.derivative, forces + 1, 2 * n * sampled);
          }
          return force;
        });
    if (keeps) ++sample;
    reference.advance();
  }
  for (Index i = 0; i < n; ++i) {
    keep(x[i].x.derivative, derivatives.arrival + 2 * i, 2 * n);
    keep(x[i].y.derivative, derivatives.arrival + 2 * i + 1, 2 * n);
  }
}

void fly_along_all(const ChainPlan& plan, const RolloutState& start, double gain,
                   const Directions& directions, std::span<const Index> samples,
                   const DirectionalDerivatives& derivatives) {
  const auto flight =
      plan.damping_ratio > 0 && gain > 0 ? fly_along_lanes<true> : fly_along_lanes<false>;
  flight(plan, start, gain, directions, samples, derivatives);
}

Index derivative_lanes() { return lanes_of(Derivatives()); }

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nuno::native {

HWY_EXPORT(fly_along_all);
HWY_EXPORT(derivative_lanes);

void fly_along(const ChainPlan& plan, const RolloutState& start, double gain,
               const Directions& directions, std::span<const Index> samples,
               const DirectionalDerivatives& derivatives) {
  assert(directions.count <= derivative_lanes());
  HWY_DYNAMIC_DISPATCH(fly_along_all)(plan, start, gain, directions, samples, derivatives);
}

Index derivative_lanes() { return HWY_DYNAMIC_DISPATCH(derivative_lanes)(); }

}  // namespace nuno::native
#endif  // HWY_ONCE
