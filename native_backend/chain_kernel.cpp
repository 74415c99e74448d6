// The chain's equations of motion, written once for every number (number-inl.h).
//
// Segment i joins particles i and i+1: direction tᵢ, length lᵢ, direction angle φᵢ; hinge j turns
// by θⱼ = φⱼ − φⱼ₋₁ at particle j.
//
// Hinges. The moment of hinge j is Mⱼ = (EI/ℓ̄)·θⱼ + (ηI/ℓ̄)·θ̇ⱼ. A segment between two hinges feels
// Mᵢ₊₁ − Mᵢ, which it hands to its ends as a couple of shear forces ±Sᵢ, Sᵢ = (Mᵢ₊₁ − Mᵢ)/lᵢ·nᵢ
// with nᵢ normal to tᵢ; that is the gradient of ½·(EI/ℓ̄)·θ².
//
// Scheme. Leapfrog: positions at whole steps, velocities at half steps,
//     v' = r·v − q·g + p·f(x),   x' = x + h·v',   r = e^(−κh), q = (1 − r)/κ, p = q/m, κ = k/m,
// exact for gravity and drag; the first kick starts from the launch velocity at t = 0, so it is
// half as long. One evaluation of the forces a step, second order.
//
// Tension. A cloth hardly stretches, and its stretch springs, taken explicitly, would force a step
// far below what the motion needs. So tension uses the mean length (lₙ₋₁ + 2lₙ + lₙ₊₁)/4, which is
// trapezoidal (Newmark β = ¼, γ = ½): stable for every stiffness, second order, no numerical
// damping. With u = t·Δv the rate of stretching before the kick and u' after it,
//     ℓ·T = EA·(l − ℓ) + c⁺·u' + c⁻·u,   c⁺ = EA·h/4 + ηA/2,   c⁻ = −EA·h/4 + ηA/2
// (first kick: c⁺ = EA·h/2 + ηA/2, c⁻ = ηA/2). u' depends on the tensions themselves,
//     u'ᵢ = u*ᵢ + p·(Tᵢ₊₁·tᵢ·tᵢ₊₁ − 2Tᵢ + Tᵢ₋₁·tᵢ₋₁·tᵢ),
// where u* is what all other forces make of u, so the tensions solve a symmetric, diagonally
// dominant tridiagonal system,
//     (2 + ℓ/(c⁺p))·Tᵢ − cosθᵢ₊₁·Tᵢ₊₁ − cosθᵢ·Tᵢ₋₁ = [u*ᵢ + (EA/c⁺)·(lᵢ − ℓᵢ) + (c⁻/c⁺)·uᵢ]/p,
// eliminated on the way up the chain and substituted on the way down.

#include "chain_kernel.h"

#include <nuno/shape_control.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <memory>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once for every target
// clang-format off: these need the target to be chosen
#include <hwy/highway.h>
#include "number-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {

template <typename T>
struct Vec2 {
  T x, y;
};
template <typename T>
HWY_INLINE Vec2<T> operator+(Vec2<T> a, Vec2<T> b) {
  return {a.x + b.x, a.y + b.y};
}
template <typename T>
HWY_INLINE Vec2<T> operator-(Vec2<T> a, Vec2<T> b) {
  return {a.x - b.x, a.y - b.y};
}
template <typename T>
HWY_INLINE Vec2<T> operator*(T a, Vec2<T> b) {
  return {a * b.x, a * b.y};
}
template <typename T>
HWY_INLINE T dot(Vec2<T> a, Vec2<T> b) {
  return mul_add(a.x, b.x, a.y * b.y);
}
template <typename T>
HWY_INLINE T cross(Vec2<T> a, Vec2<T> b) {
  return neg_mul_add(a.y, b.x, a.x * b.y);
}

/// What the way up the chain leaves for the way down, per segment.
template <typename T>
struct Elimination {
  Vec2<T> direction;
  T offset;  ///< Tᵢ = offset + factor·Tᵢ₊₁
  T factor;
};

/// Sums over the particles.
template <typename T>
struct Sums {
  Vec2<T> position;
  Vec2<T> velocity;  ///< only where control is damped
};

/// One step. `external(j, x, v)` is the force on particle j; returns the sums after the step.
template <bool damped_hinges, bool damped_control, typename T, typename External>
HWY_INLINE Sums<T> advance(const ChainPlan& plan, const ChainPlan::Kick& kick, Vec2<T>* x,
                           Vec2<T>* v, Elimination<T>* segments, External&& external) {
  const Index n = plan.particles;
  const double* rest_length = plan.rest_length.data();
  const double* spring = plan.hinge_spring.data();
  const double* dashpot = plan.hinge_dashpot.data();
  const double* diagonal = kick.diagonal.data();
  const double per_force = 1 / kick.force;
  const T zero = Constant<T>::of(0);

  // On the way up, particle j − 1 is kicked as soon as hinge j is known, and segment j − 2 is
  // eliminated as soon as both its ends are kicked.
  Vec2<T> t1{zero, zero}, t2{zero, zero};  // directions of segments j − 1, j − 2
  T inverse1 = zero;                       // 1/l of segment j − 1
  T turning1 = zero;                       // φ̇ of segment j − 1
  T moment1 = zero;                        // of hinge j − 1
  T load1 = zero, load2 = zero;            // what strain and old rate put on the right-hand side
  T cosine1 = zero, cosine2 = zero;        // of hinges j − 1, j − 2
  Vec2<T> shear2{zero, zero};              // of segment j − 2
  Vec2<T> kicked2{zero, zero};             // velocity of particle j − 2
  T offset3 = zero, factor3 = zero;        // of segment j − 3
  for (Index j = 0; j <= n; ++j) {
    Vec2<T> t{zero, zero};
    T inverse = zero, turning = zero, moment = zero, load = zero, cosine = zero;
    if (j + 1 < n) {
      const Vec2<T> span = x[j + 1] - x[j];
      const Vec2<T> rate = v[j + 1] - v[j];
      const T squared = dot(span, span);
      inverse = rsqrt(squared);
      t = inverse * span;
      load = scale_add(kick.strain, shift(-rest_length[j], squared * inverse),
                       scale(kick.rate, dot(t, rate)));
      if constexpr (damped_hinges) turning = cross(t, rate) * inverse;
      if (j > 0) {
        cosine = dot(t1, t);
        moment = scale(spring[j], angle(cross(t1, t), cosine));
        if constexpr (damped_hinges) moment = scale_add(dashpot[j], turning - turning1, moment);
      }
    }
    Vec2<T> shear1{zero, zero}, kicked1{zero, zero};
    if (j > 0) {
      const T couple = (moment - moment1) * inverse1;
      shear1 = {couple * (zero - t1.y), couple * t1.x};
      const Vec2<T> force = (shear2 - shear1) + external(j - 1, x[j - 1], v[j - 1]);
      kicked1 = {scale_add(kick.keep, v[j - 1].x, scale(kick.force, force.x)),
                 scale_add(kick.keep, v[j - 1].y,
                           scale_add(kick.force, force.y, Constant<T>::of(-kick.fall)))};
      v[j - 1] = kicked1;
    }
    if (j > 1) {
      // cosine1 is of hinge j − 1, between segments j − 2 and j − 1; cosine2 of hinge j − 2.
      const T free_rate = dot(t2, kicked1 - kicked2);
      const T right = scale(per_force, free_rate + load2);
      const T pivot = reciprocal(neg_mul_add(cosine2, factor3, Constant<T>::of(diagonal[j - 2])));
      const T offset = mul_add(cosine2, offset3, right) * pivot;
      const T factor = cosine1 * pivot;
      segments[j - 2] = {t2, offset, factor};
      offset3 = offset;
      factor3 = factor;
    }
    t2 = t1;
    t1 = t;
    inverse1 = inverse;
    turning1 = turning;
    moment1 = moment;
    load2 = load1;
    load1 = load;
    cosine2 = cosine1;
    cosine1 = cosine;
    shear2 = shear1;
    kicked2 = kicked1;
  }

  Sums<T> sums{{zero, zero}, {zero, zero}};
  Vec2<T> above{zero, zero};  // tension of the segment above, along it
  T tension = zero;
  for (Index i = n; i-- > 0;) {
    Vec2<T> below{zero, zero};
    if (i > 0) {
      tension = mul_add(segments[i - 1].factor, tension, segments[i - 1].offset);
      below = tension * segments[i - 1].direction;
    }
    const Vec2<T> pull = above - below;
    v[i] = {scale_add(kick.force, pull.x, v[i].x), scale_add(kick.force, pull.y, v[i].y)};
    x[i] = {scale_add(plan.h, v[i].x, x[i].x), scale_add(plan.h, v[i].y, x[i].y)};
    sums.position = sums.position + x[i];
    if constexpr (damped_control) sums.velocity = sums.velocity + v[i];
    above = below;
  }
  return sums;
}

template <bool damped_control, typename T, typename External>
HWY_INLINE Sums<T> advance(const ChainPlan& plan, bool first, Vec2<T>* x, Vec2<T>* v,
                           Elimination<T>* segments, External&& external) {
  const ChainPlan::Kick& kick = first ? plan.first : plan.full;
  return plan.hinge_dashpot.empty()
             ? advance<false, damped_control>(plan, kick, x, v, segments, external)
             : advance<true, damped_control>(plan, kick, x, v, segments, external);
}

void step_scalar(const ChainPlan& plan, bool first, const double* forces, double* positions,
                 double* velocities, ScalarScratch& scratch) {
  static_assert(sizeof(Vec2<Real>) == 2 * sizeof(double) &&
                sizeof(Elimination<Real>) == 4 * sizeof(double));
  advance<false>(plan, first, reinterpret_cast<Vec2<Real>*>(positions),
                 reinterpret_cast<Vec2<Real>*>(velocities),
                 reinterpret_cast<Elimination<Real>*>(scratch.values.data()),
                 [forces](Index j, const Vec2<Real>&, const Vec2<Real>&) HWY_ATTR {
                   return Vec2<Real>{forces[2 * j], forces[2 * j + 1]};
                 });
}

// ---- a flight for as many gains as the number has lanes ---------------------------------------

HWY_INLINE Index lanes_of(Real) { return 1; }
HWY_INLINE Index lanes_of(Pack) { return static_cast<Index>(hn::Lanes(Pack::Tag())); }
HWY_INLINE Real load_lanes(const double* values, Real) { return *values; }
HWY_INLINE Pack load_lanes(const double* values, Pack) { return hn::LoadU(Pack::Tag(), values); }
HWY_INLINE void store_lanes(Real number, double* values) { *values = number; }
HWY_INLINE void store_lanes(Pack number, double* values) {
  hn::StoreU(number.lanes, Pack::Tag(), values);
}

HWY_INLINE Real gain_number(const double* gains, Real) { return *gains; }
HWY_INLINE Pack gain_number(const double* gains, Pack) { return load_lanes(gains, Pack()); }
template <typename T>
HWY_INLINE Dual<T> gain_number(const double* gains, Dual<T>) {
  return {load_lanes(gains, T()), T(1.0)};
}

template <typename T>
HWY_INLINE Index lanes_of(Dual<T>) {
  return lanes_of(T());
}
/// Lanes of a coordinate: value to `finals`, slope to `tangents`, `stride` apart.
template <typename T>
HWY_INLINE void write_lanes(T number, double* finals, double*, Index stride, Index count) {
  double values[HWY_MAX_BYTES / sizeof(double)] = {};
  store_lanes(number, values);
  for (Index lane = 0; lane < count; ++lane) finals[lane * stride] = values[lane];
}
template <typename T>
HWY_INLINE void write_lanes(Dual<T> number, double* finals, double* tangents, Index stride,
                            Index count) {
  write_lanes(number.value, finals, nullptr, stride, count);
  write_lanes(number.slope, tangents, nullptr, stride, count);
}

/// β = 2ζ·√(α·m), shape_damping of the core; its slope is β/2α.
HWY_INLINE Real damping_number(const double* gains, double ratio, double mass, Real) {
  return shape_damping(ratio, *gains, mass);
}
HWY_INLINE Pack damping_number(const double* gains, double ratio, double mass, Pack) {
  double damping[HWY_MAX_BYTES / sizeof(double)] = {};
  for (Index lane = 0; lane < lanes_of(Pack()); ++lane) {
    damping[lane] = shape_damping(ratio, gains[lane], mass);
  }
  return load_lanes(damping, Pack());
}
template <typename T>
HWY_INLINE Dual<T> damping_number(const double* gains, double ratio, double mass, Dual<T>) {
  const T damping = damping_number(gains, ratio, mass, T());
  const T gain = load_lanes(gains, T());
  // At α = 0 the slope is infinite; there it is given as none.
  const T slope = where_greater(gain, T(0.0), T(0.5) * damping / gain, T(0.0));
  return {damping, slope};
}

template <bool damped_control, typename T>
void fly_lanes(const ChainPlan& plan, ReferenceMotion reference, const double* initial,
               const double* launch_velocity, const double* gains, Index count, double* finals,
               double* tangents) {
  const Index n = plan.particles;
  const auto size = static_cast<std::size_t>(n);
  const std::unique_ptr<Vec2<T>[]> x(new Vec2<T>[size]);
  const std::unique_ptr<Vec2<T>[]> v(new Vec2<T>[size]);
  const std::unique_ptr<Elimination<T>[]> segments(new Elimination<T>[size]);
  const T zero = Constant<T>::of(0);
  Sums<T> sums{{zero, zero}, {zero, zero}};
  for (Index i = n; i-- > 0;) {
    x[i] = {Constant<T>::of(initial[2 * i]), Constant<T>::of(initial[2 * i + 1])};
    v[i] = {Constant<T>::of(launch_velocity[2 * i]), Constant<T>::of(launch_velocity[2 * i + 1])};
    sums.position = sums.position + x[i];
    sums.velocity = sums.velocity + v[i];
  }

  double padded[HWY_MAX_BYTES / sizeof(double)] = {};
  for (Index lane = 0; lane < lanes_of(T()); ++lane) {
    padded[lane] = gains[std::min(lane, count - 1)];
  }
  const T gain = gain_number(padded, T());
  const T damping = damping_number(padded, plan.damping_ratio, plan.particle_mass, T());
  const T particles = Constant<T>::of(static_cast<double>(n));
  for (Index step = 0; step < plan.steps; ++step) {
    const double* shape = reference.shape().data();
    const double* motion = reference.velocity().data();
    const Vec2<T> center{divide(sums.position.x, particles), divide(sums.position.y, particles)};
    const Vec2<T> drift{divide(sums.velocity.x, particles), divide(sums.velocity.y, particles)};
    sums = advance<damped_control>(
        plan, step == 0, x.get(), v.get(), segments.get(),
        [&](Index j, const Vec2<T>& position, const Vec2<T>& velocity) HWY_ATTR {
          Vec2<T> force{gain * shift(shape[2 * j], center.x - position.x),
                        gain * shift(shape[2 * j + 1], center.y - position.y)};
          if constexpr (damped_control) {
            force = force + Vec2<T>{damping * shift(motion[2 * j], drift.x - velocity.x),
                                    damping * shift(motion[2 * j + 1], drift.y - velocity.y)};
          }
          return force;
        });
    reference.advance();
  }
  for (Index i = 0; i < n; ++i) {
    write_lanes(x[i].x, finals + 2 * i, tangents + 2 * i, 2 * n, count);
    write_lanes(x[i].y, finals + 2 * i + 1, tangents + 2 * i + 1, 2 * n, count);
  }
}

template <typename T>
void fly_lanes(const ChainPlan& plan, const ReferenceMotion& reference, const double* initial,
               const double* launch_velocity, const double* gains, Index count, double* finals,
               double* tangents) {
  const auto flight = plan.damping_ratio > 0 ? fly_lanes<true, T> : fly_lanes<false, T>;
  flight(plan, reference, initial, launch_velocity, gains, count, finals, tangents);
}

/// The number whose value is the same in every lane and whose slope differs.
HWY_INLINE Dual<Pack> with_slopes(double value, Pack slope) { return {Pack(value), slope}; }

template <bool damped_control>
void fly_along_lanes(const ChainPlan& plan, ReferenceMotion reference, const double* initial,
                     const double* launch_velocity, double gain, const double* aim_directions,
                     Index count, double* tangents) {
  using T = Dual<Pack>;
  const Index n = plan.particles;
  const auto size = static_cast<std::size_t>(n);
  const std::unique_ptr<Vec2<T>[]> x(new Vec2<T>[size]);
  const std::unique_ptr<Vec2<T>[]> v(new Vec2<T>[size]);
  const std::unique_ptr<Vec2<Pack>[]> aim(new Vec2<Pack>[size]);
  const std::unique_ptr<Elimination<T>[]> segments(new Elimination<T>[size]);
  // One coordinate of all directions, a direction a lane.
  const auto across = [&](const double* directions, Index coordinate) HWY_ATTR {
    double values[HWY_MAX_BYTES / sizeof(double)] = {};
    for (Index lane = 0; lane < count; ++lane) {
      values[lane] = directions[lane * 2 * n + coordinate];
    }
    return load_lanes(values, Pack());
  };
  const T zero = Constant<T>::of(0);
  Sums<T> sums{{zero, zero}, {zero, zero}};
  for (Index i = n; i-- > 0;) {
    aim[i] = {across(aim_directions, 2 * i), across(aim_directions, 2 * i + 1)};
    x[i] = {Constant<T>::of(initial[2 * i]), Constant<T>::of(initial[2 * i + 1])};
    v[i] = {Constant<T>::of(launch_velocity[2 * i]), Constant<T>::of(launch_velocity[2 * i + 1])};
    sums.position = sums.position + x[i];
    sums.velocity = sums.velocity + v[i];
  }

  const double damping = shape_damping(plan.damping_ratio, gain, plan.particle_mass);
  const T particles = Constant<T>::of(static_cast<double>(n));
  for (Index step = 0; step < plan.steps; ++step) {
    const double* shape = reference.shape().data();
    const double* motion = reference.velocity().data();
    const Pack share(reference.aim_share());
    const Pack rate(reference.aim_rate());
    const Vec2<T> center{divide(sums.position.x, particles), divide(sums.position.y, particles)};
    const Vec2<T> drift{divide(sums.velocity.x, particles), divide(sums.velocity.y, particles)};
    sums = advance<damped_control>(
        plan, step == 0, x.get(), v.get(), segments.get(),
        [&](Index j, const Vec2<T>& position, const Vec2<T>& velocity) HWY_ATTR {
          const Vec2<T> place{with_slopes(shape[2 * j], share * aim[j].x),
                              with_slopes(shape[2 * j + 1], share * aim[j].y)};
          const Vec2<T> miss = place + (center - position);
          Vec2<T> force{scale(gain, miss.x), scale(gain, miss.y)};
          if constexpr (damped_control) {
            const Vec2<T> speed{with_slopes(motion[2 * j], rate * aim[j].x),
                                with_slopes(motion[2 * j + 1], rate * aim[j].y)};
            const Vec2<T> lag = speed + (drift - velocity);
            force = force + Vec2<T>{scale(damping, lag.x), scale(damping, lag.y)};
          }
          return force;
        });
    reference.advance();
  }
  for (Index i = 0; i < n; ++i) {
    write_lanes(x[i].x.slope, tangents + 2 * i, nullptr, 2 * n, count);
    write_lanes(x[i].y.slope, tangents + 2 * i + 1, nullptr, 2 * n, count);
  }
}

void fly_along_all(const ChainPlan& plan, const ReferenceMotion& reference, const double* initial,
                   const double* launch_velocity, double gain, const double* aim_directions,
                   Index count, double* tangents) {
  const auto flight =
      plan.damping_ratio > 0 && gain > 0 ? fly_along_lanes<true> : fly_along_lanes<false>;
  for (Index first = 0; first < count; first += lanes_of(Pack())) {
    const Index skip = first * 2 * plan.particles;
    flight(plan, reference, initial, launch_velocity, gain, aim_directions + skip,
           std::min(lanes_of(Pack()), count - first), tangents + skip);
  }
}

void fly_all(const ChainPlan& plan, const ReferenceMotion& reference, const double* initial,
             const double* launch_velocity, const double* gains, Index count, double* finals,
             double* tangents) {
  const Index wide = lanes_of(Pack());
  for (Index first = 0; first < count; first += wide) {
    const Index here = std::min(wide, count - first);
    double* out = finals + first * 2 * plan.particles;
    double* out_tangents = tangents == nullptr ? nullptr : tangents + first * 2 * plan.particles;
    if (tangents != nullptr) {
      fly_lanes<Dual<Pack>>(plan, reference, initial, launch_velocity, gains + first, here, out,
                            out_tangents);
    } else if (here == 1) {
      fly_lanes<Real>(plan, reference, initial, launch_velocity, gains + first, here, out, nullptr);
    } else {
      fly_lanes<Pack>(plan, reference, initial, launch_velocity, gains + first, here, out, nullptr);
    }
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
HWY_EXPORT(fly_along_all);
HWY_EXPORT(lanes);
HWY_EXPORT(instruction_set);

void step(const ChainPlan& plan, bool first, const double* forces, double* positions,
          double* velocities, ScalarScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(step_scalar)(plan, first, forces, positions, velocities, scratch);
}

void fly(const ChainPlan& plan, const ReferenceMotion& reference, const double* initial,
         const double* launch_velocity, std::span<const double> gains, double* finals,
         double* tangents) {
  HWY_DYNAMIC_DISPATCH(fly_all)
  (plan, reference, initial, launch_velocity, gains.data(), static_cast<Index>(gains.size()),
   finals, tangents);
}

void fly_along(const ChainPlan& plan, const ReferenceMotion& reference, const double* initial,
               const double* launch_velocity, double gain, const double* aim_directions,
               Index count, double* tangents) {
  HWY_DYNAMIC_DISPATCH(fly_along_all)
  (plan, reference, initial, launch_velocity, gain, aim_directions, count, tangents);
}

Index lanes() { return HWY_DYNAMIC_DISPATCH(lanes)(); }
std::string instruction_set() { return HWY_DYNAMIC_DISPATCH(instruction_set)(); }

}  // namespace nuno::native
#endif  // HWY_ONCE
