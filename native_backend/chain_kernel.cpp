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
//     (2 + ℓ/(c⁺p))·τᵢ − cosθᵢ₊₁·τᵢ₊₁ − cosθᵢ·τᵢ₋₁ = u*ᵢ + (EA/c⁺)·(lᵢ − ℓᵢ) + (c⁻/c⁺)·uᵢ,   τ =
//     p·T,
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

// For lambdas: compiled for the target and always inlined. One that GCC 12 leaves on its own, as it
// does in sanitized builds, finds its captures broken where the caller's stack is realigned for
// wide vectors.
#undef NUNO_INLINE_LAMBDA
#define NUNO_INLINE_LAMBDA __attribute__((always_inline)) HWY_ATTR

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

/// A segment on the way up: first what it is, then its row of the eliminated system.
template <typename T>
struct Segment {
  Vec2<T> direction;
  T offset;  ///< first what strain and old rate put on the right; then τᵢ = offset + factor·τᵢ₊₁
  T factor;  ///< first cosθᵢ of the hinge below
};

/// Sums over the particles.
template <typename T>
struct Sums {
  Vec2<T> position;
  Vec2<T> velocity;  ///< only where control is damped
};

/// The way up goes strip by strip and in four loops over each, whose iterations wait for little of
/// each other. A strip is so short that the processor looks beyond its end: while the elimination
/// waits for its divisions, the next strip begins.
constexpr Index strip_length = 8;

/// Quantities of the segments or hinges first − 1 … first + strip_length − 1.
template <typename T>
struct Strip {
  Index first = 0;
  T values[strip_length + 1];

  HWY_INLINE T& operator[](Index i) { return values[i - first + 1]; }
  HWY_INLINE void advance() {
    values[0] = values[strip_length];
    first += strip_length;
  }
};

/// On the way up: kicks with all forces but tension, and eliminates the tensions.
template <bool damped_hinges, typename T, typename External>
HWY_INLINE void go_up(const ChainPlan& plan, const ChainPlan::Kick& kick, const Vec2<T>* x,
                      Vec2<T>* v, Segment<T>* segments, External&& external) {
  using Value = typename Constant<T>::Value;
  const Index n = plan.particles;
  const double* rest_length = plan.rest_length.data();
  const double* spring = plan.hinge_spring.data();
  const double* dashpot = plan.hinge_dashpot.data();
  const T zero = Constant<T>::of(0);

  Strip<T> inverse, turning, moment;  // 1/lᵢ, φ̇ᵢ, Mⱼ
  Vec2<T> below{zero, zero};          // direction of the segment below the particle
  T couple_below = zero;
  const auto kick_particle = [&](Index i, Vec2<T> above, T couple) NUNO_INLINE_LAMBDA {
    const Vec2<T> force = external(i, x[i], v[i]);
    const T vx = scale_add(kick.force, force.x, scale(kick.keep, v[i].x));
    const T vy = scale_add(kick.force, force.y, shift(-kick.fall, scale(kick.keep, v[i].y)));
    v[i] = {neg_mul_add(couple_below, below.y, mul_add(couple, above.y, vx)),
            mul_add(couple_below, below.x, neg_mul_add(couple, above.x, vy))};
    below = above;
    couple_below = couple;
  };
  T offset = zero, factor = zero;  // of the segment below
  const auto eliminate = [&](Index i, T cosine_above) NUNO_INLINE_LAMBDA {
    Segment<T>& s = segments[i];
    const Vec2<T> rate = v[i + 1] - v[i];
    const T right = mul_add(s.direction.x, rate.x, mul_add(s.direction.y, rate.y, s.offset));
    const Value diagonal = mul_add(Value(rest_length[i]), Value(kick.compliance), Value(2.0));
    const T pivot = reciprocal_of_difference(diagonal, s.factor, factor);
    offset = mul_add(s.factor, offset, right) * pivot;
    factor = cosine_above * pivot;
    s.offset = offset;
    s.factor = factor;
  };

  moment[0] = zero;
  segments[0].factor = zero;
  // Hinge j follows segment j, particle j − 1 hinge j, and segment j − 2 both its ends.
  for (Index first = 0; first < n; first += strip_length) {
    const Index end = std::min(first + strip_length, n);
    for (Index i = first; i < std::min(end, n - 1); ++i) {
      const Vec2<T> span = x[i + 1] - x[i];
      const Vec2<T> rate = v[i + 1] - v[i];
      const T squared = dot(span, span);
      inverse[i] = rsqrt(squared);
      const Vec2<T> t = inverse[i] * span;
      segments[i].direction = t;
      segments[i].offset = scale_add(kick.strain, shift(-rest_length[i], squared * inverse[i]),
                                     scale(kick.rate, dot(t, rate)));
      if constexpr (damped_hinges) turning[i] = cross(t, rate) * inverse[i];
    }
    for (Index j = std::max<Index>(first, 1); j < std::min(end, n - 1); ++j) {
      const Vec2<T> before = segments[j - 1].direction, after = segments[j].direction;
      const T cosine = dot(before, after);
      segments[j].factor = cosine;
      moment[j] = scale(spring[j], angle(cross(before, after), cosine));
      if constexpr (damped_hinges) {
        moment[j] = scale_add(dashpot[j], turning[j] - turning[j - 1], moment[j]);
      }
    }
    if (end == n) moment[n - 1] = zero;
    for (Index j = std::max<Index>(first, 1); j < end; ++j) {
      const T couple = (moment[j] - moment[j - 1]) * scale(kick.force, inverse[j - 1]);
      kick_particle(j - 1, segments[j - 1].direction, couple);
    }
    for (Index j = std::max<Index>(first, 2); j < end; ++j) {
      eliminate(j - 2, segments[j - 1].factor);
    }
    inverse.advance();
    turning.advance();
    moment.advance();
  }
  kick_particle(n - 1, {zero, zero}, zero);
  eliminate(n - 2, zero);
}

/// On the way down: substitutes, adds the tensions to the kick and moves.
template <bool damped_control, typename T>
HWY_INLINE Sums<T> go_down(const ChainPlan& plan, Vec2<T>* x, Vec2<T>* v,
                           const Segment<T>* segments) {
  const T zero = Constant<T>::of(0);
  Sums<T> sums{{zero, zero}, {zero, zero}};
  Vec2<T> pulled = v[plan.particles - 1];  // by the segment above
  T tension = zero;                        // τ
  const auto move = [&](Index i, Vec2<T> velocity) NUNO_INLINE_LAMBDA {
    v[i] = velocity;
    x[i] = {scale_add(plan.h, velocity.x, x[i].x), scale_add(plan.h, velocity.y, x[i].y)};
    sums.position = sums.position + x[i];
    if constexpr (damped_control) sums.velocity = sums.velocity + velocity;
  };
  for (Index i = plan.particles - 1; i-- > 0;) {
    const Segment<T> s = segments[i];
    tension = mul_add(s.factor, tension, s.offset);
    move(i + 1, {neg_mul_add(tension, s.direction.x, pulled.x),
                 neg_mul_add(tension, s.direction.y, pulled.y)});
    pulled = {mul_add(tension, s.direction.x, v[i].x), mul_add(tension, s.direction.y, v[i].y)};
  }
  move(0, pulled);
  return sums;
}

/// One step. `external(j, x, v)` is the force on particle j; returns the sums after the step.
template <bool damped_control, typename T, typename External>
HWY_INLINE Sums<T> advance(const ChainPlan& plan, bool first, Vec2<T>* x, Vec2<T>* v,
                           Segment<T>* segments, External&& external) {
  const ChainPlan::Kick& kick = first ? plan.first : plan.full;
  if (plan.hinge_dashpot.empty()) {
    go_up<false>(plan, kick, x, v, segments, external);
  } else {
    go_up<true>(plan, kick, x, v, segments, external);
  }
  return go_down<damped_control>(plan, x, v, segments);
}

void step_scalar(const ChainPlan& plan, bool first, const double* forces, double* positions,
                 double* velocities, ScalarScratch& scratch) {
  static_assert(sizeof(Vec2<Real>) == 2 * sizeof(double) &&
                sizeof(Segment<Real>) == 4 * sizeof(double));
  advance<false>(plan, first, reinterpret_cast<Vec2<Real>*>(positions),
                 reinterpret_cast<Vec2<Real>*>(velocities),
                 reinterpret_cast<Segment<Real>*>(scratch.values.data()),
                 [forces](Index j, const Vec2<Real>&, const Vec2<Real>&) NUNO_INLINE_LAMBDA {
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

// Numbers of a gain in every lane; `seeds` is 1 where the slope is with respect to it, 0 elsewhere.
HWY_INLINE Real gain_number(const double* gains, const double*, Real) { return *gains; }
HWY_INLINE Pack gain_number(const double* gains, const double*, Pack) {
  return load_lanes(gains, Pack());
}
template <typename T>
HWY_INLINE Dual<T> gain_number(const double* gains, const double* seeds, Dual<T>) {
  return {load_lanes(gains, T()), load_lanes(seeds, T())};
}

template <typename T>
HWY_INLINE Index lanes_of(Dual<T>) {
  return lanes_of(T());
}
/// Lanes of coordinate `at`: value to `finals`, slope to `tangents`, `stride` apart.
template <typename T>
HWY_INLINE void write_lanes(T number, double* finals, double*, Index at, Index stride,
                            Index count) {
  double values[HWY_MAX_BYTES / sizeof(double)] = {};
  store_lanes(number, values);
  for (Index lane = 0; lane < count; ++lane) finals[at + lane * stride] = values[lane];
}
template <typename T>
HWY_INLINE void write_lanes(Dual<T> number, double* finals, double* tangents, Index at,
                            Index stride, Index count) {
  write_lanes(number.value, finals, nullptr, at, stride, count);
  write_lanes(number.slope, tangents, nullptr, at, stride, count);
}

/// β = 2ζ·√(α·m), shape_damping of the core; its slope is β/2α.
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
  // At α = 0 the slope is infinite; there it is given as none.
  const T slope = where_greater(gain, T(0.0), T(0.5) * damping / gain, T(0.0));
  return {damping, load_lanes(seeds, T()) * slope};
}

/// What one group of modes is pulled with.
template <typename T>
struct GroupNumbers {
  T gain, damping;
};
template <typename T>
HWY_INLINE GroupNumbers<T> group_numbers(const ChainPlan& plan, const FlightGains& gains,
                                         Index group) {
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

/// The part of shape control by which the low modes' gains differ from the last group's.
template <typename T>
struct LowModePull {
  Index count = 0;
  const double* shapes = nullptr;  ///< [modes × N]
  GroupNumbers<T> excess[most_low_modes];
  Vec2<T> amplitude[most_low_modes];  ///< of the force on each mode

  HWY_INLINE void prepare(const ChainPlan& plan, const FlightGains& gains) {
    const GroupNumbers<T> rest = group_numbers<T>(plan, gains, gains.groups() - 1);
    count = gains.low_modes->count();
    shapes = gains.low_modes->shapes.data();
    for (Index j = 0; j < count; ++j) {
      const Index group = gains.low_modes->group[static_cast<std::size_t>(j)];
      const GroupNumbers<T> own = group_numbers<T>(plan, gains, group);
      excess[j] = {own.gain - rest.gain, own.damping - rest.damping};
    }
  }

  /// Projects what is missing of shape and velocity, `offset(i)` and `lag(i)` at particle i.
  template <typename Offset, typename Lag>
  HWY_INLINE void project(Index particles, Offset&& offset, Lag&& lag) {
    const T zero = Constant<T>::of(0);
    Vec2<T> spring[most_low_modes], dashpot[most_low_modes];
    for (Index j = 0; j < count; ++j) spring[j] = dashpot[j] = {zero, zero};
    for (Index i = 0; i < particles; ++i) {
      const Vec2<T> o = offset(i);
      const Vec2<T> u = lag(i);
      for (Index j = 0; j < count; ++j) {
        const double weight = shapes[i * count + j];
        spring[j] = spring[j] + Vec2<T>{scale(weight, o.x), scale(weight, o.y)};
        dashpot[j] = dashpot[j] + Vec2<T>{scale(weight, u.x), scale(weight, u.y)};
      }
    }
    for (Index j = 0; j < count; ++j) {
      amplitude[j] = excess[j].gain * spring[j] + excess[j].damping * dashpot[j];
    }
  }

  HWY_INLINE Vec2<T> add_to(Vec2<T> force, Index i) const {
    for (Index j = 0; j < count; ++j) {
      const double weight = shapes[i * count + j];
      force = force + Vec2<T>{scale(weight, amplitude[j].x), scale(weight, amplitude[j].y)};
    }
    return force;
  }
};

/// What shape control is made of: springs, dashpots too, and both with gains by group.
enum class Control { springs, damped, grouped };

template <Control control, typename T>
void fly_lanes(const ChainPlan& plan, ReferenceMotion reference, const double* initial,
               const double* launch_velocity, const FlightGains& gains, double* finals,
               double* tangents) {
  constexpr bool damped_control = control != Control::springs;
  const Index n = plan.particles;
  const auto size = static_cast<std::size_t>(n);
  const std::unique_ptr<Vec2<T>[]> x(new Vec2<T>[size]);
  const std::unique_ptr<Vec2<T>[]> v(new Vec2<T>[size]);
  const std::unique_ptr<Segment<T>[]> segments(new Segment<T>[size]);
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
  LowModePull<T> low_modes;
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
          n, [&](Index j) NUNO_INLINE_LAMBDA { return offset(j, x[j]); },
          [&](Index j) NUNO_INLINE_LAMBDA { return lag(j, v[j]); });
    }
    sums = advance<damped_control>(plan, step == 0, x.get(), v.get(), segments.get(),
                                   [&](Index j, const Vec2<T>& position, const Vec2<T>& velocity)
                                       NUNO_INLINE_LAMBDA {
                                         Vec2<T> force = gain * offset(j, position);
                                         if constexpr (damped_control)
                                           force = force + damping * lag(j, velocity);
                                         if constexpr (control == Control::grouped)
                                           force = low_modes.add_to(force, j);
                                         return force;
                                       });
    reference.advance();
  }
  const Index count = gains.flights();
  for (Index i = 0; i < n; ++i) {
    write_lanes(x[i].x, finals, tangents, 2 * i, 2 * n, count);
    write_lanes(x[i].y, finals, tangents, 2 * i + 1, 2 * n, count);
  }
}

/// Gains by group take the damped path, whose dashpots may be nothing.
template <typename T>
auto flight_of(const ChainPlan& plan, const FlightGains& gains) {
  if (gains.low_modes != nullptr) return fly_lanes<Control::grouped, T>;
  return plan.damping_ratio > 0 ? fly_lanes<Control::damped, T> : fly_lanes<Control::springs, T>;
}

// ---- derivatives of a flight along as many directions as a pair of packs has lanes -------------

using Slopes = Pair<Pack>;
HWY_INLINE Index lanes_of(Slopes) { return 2 * lanes_of(Pack()); }
HWY_INLINE Slopes load_lanes(const double* values, Slopes) {
  return {load_lanes(values, Pack()), load_lanes(values + lanes_of(Pack()), Pack())};
}
HWY_INLINE void store_lanes(Slopes number, double* values) {
  store_lanes(number.first, values);
  store_lanes(number.second, values + lanes_of(Pack()));
}
constexpr std::size_t most_slopes = std::size_t{2} * HWY_MAX_BYTES / sizeof(double);

/// The number whose value is the same in every lane and whose slopes differ.
HWY_INLINE Dual<Pack, Slopes> with_slopes(double value, Slopes slopes) {
  return {Pack(value), slopes};
}

template <bool damped_control>
void fly_along_lanes(const ChainPlan& plan, const FlightState& start, double gain,
                     const Directions& directions, std::span<const Index> samples,
                     const Tangents& tangents) {
  using T = Dual<Pack, Slopes>;
  const Index n = plan.particles;
  const auto size = static_cast<std::size_t>(n);
  const std::unique_ptr<Vec2<T>[]> x(new Vec2<T>[size]);
  const std::unique_ptr<Vec2<T>[]> v(new Vec2<T>[size]);
  const std::unique_ptr<Vec2<Slopes>[]> aim(new Vec2<Slopes>[size]);
  const std::unique_ptr<Segment<T>[]> segments(new Segment<T>[size]);
  // A value of each direction, a direction a lane.
  const auto across = [&](auto value_of) NUNO_INLINE_LAMBDA {
    double values[most_slopes] = {};
    for (Index lane = 0; lane < directions.count; ++lane) values[lane] = value_of(lane);
    return load_lanes(values, Slopes());
  };
  const auto coordinate = [&](const double* shapes, Index at) NUNO_INLINE_LAMBDA {
    return across([=](Index lane) NUNO_INLINE_LAMBDA { return shapes[lane * 2 * n + at]; });
  };
  const auto of_power = [&](const AimShares& shares) NUNO_INLINE_LAMBDA {
    return across([&](Index lane) NUNO_INLINE_LAMBDA {
      return shares[static_cast<std::size_t>(directions.powers[lane])];
    });
  };
  const auto keep = [&](Slopes slopes, double* to, Index stride) NUNO_INLINE_LAMBDA {
    double values[most_slopes];
    store_lanes(slopes, values);
    for (Index lane = 0; lane < directions.count; ++lane) to[lane * stride] = values[lane];
  };
  const T zero = Constant<T>::of(0);
  Sums<T> sums{{zero, zero}, {zero, zero}};
  for (Index i = n; i-- > 0;) {
    aim[i] = {coordinate(directions.shapes, 2 * i), coordinate(directions.shapes, 2 * i + 1)};
    x[i] = {Constant<T>::of(start.positions(0, i)), Constant<T>::of(start.positions(1, i))};
    v[i] = {with_slopes(start.velocities(0, i), coordinate(directions.launches, 2 * i)),
            with_slopes(start.velocities(1, i), coordinate(directions.launches, 2 * i + 1))};
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
    const Slopes share = of_power(reference.aim_shares());
    const Slopes rate = of_power(reference.aim_rates());
    const bool keeps = sample < sampled && samples[static_cast<std::size_t>(sample)] == step;
    const Vec2<T> center{divide(sums.position.x, particles), divide(sums.position.y, particles)};
    const Vec2<T> drift{divide(sums.velocity.x, particles), divide(sums.velocity.y, particles)};
    sums = advance<damped_control>(
        plan, step == 0, x.get(), v.get(), segments.get(),
        [&](Index j, const Vec2<T>& position, const Vec2<T>& velocity) NUNO_INLINE_LAMBDA {
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
          if (keeps) {
            double* slopes = tangents.forces + 2 * (sample * n + j);
            keep(force.x.slope, slopes, 2 * n * sampled);
            keep(force.y.slope, slopes + 1, 2 * n * sampled);
          }
          return force;
        });
    if (keeps) ++sample;
    reference.advance();
  }
  for (Index i = 0; i < n; ++i) {
    keep(x[i].x.slope, tangents.arrival + 2 * i, 2 * n);
    keep(x[i].y.slope, tangents.arrival + 2 * i + 1, 2 * n);
  }
}

void fly_along_all(const ChainPlan& plan, const FlightState& start, double gain,
                   const Directions& directions, std::span<const Index> samples,
                   const Tangents& tangents) {
  const auto flight =
      plan.damping_ratio > 0 && gain > 0 ? fly_along_lanes<true> : fly_along_lanes<false>;
  flight(plan, start, gain, directions, samples, tangents);
}

void fly_all(const ChainPlan& plan, const ReferenceMotion& reference, const double* initial,
             const double* launch_velocity, const FlightGains& gains, double* finals,
             double* tangents) {
  const Index wide = lanes_of(Pack());
  const Index count = gains.flights();
  for (Index first = 0; first < count; first += wide) {
    const FlightGains here = gains.part(first, std::min(wide, count - first));
    double* out = finals + first * 2 * plan.particles;
    double* out_tangents = tangents == nullptr ? nullptr : tangents + first * 2 * plan.particles;
    const auto flight = tangents != nullptr   ? flight_of<Dual<Pack>>(plan, here)
                        : here.flights() == 1 ? flight_of<Real>(plan, here)
                                              : flight_of<Pack>(plan, here);
    flight(plan, reference, initial, launch_velocity, here, out, out_tangents);
  }
}

Index lanes() { return lanes_of(Pack()); }
Index slopes() { return lanes_of(Slopes()); }
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
HWY_EXPORT(slopes);
HWY_EXPORT(instruction_set);

FlightGains FlightGains::part(Index first, Index count) const {
  const auto at = [](Index index) { return static_cast<std::size_t>(index); };
  FlightGains result = *this;
  result.values = values.subspan(at(first * groups()), at(count * groups()));
  if (!seeds.empty()) result.seeds = seeds.subspan(at(first), at(count));
  return result;
}

void step(const ChainPlan& plan, bool first, const double* forces, double* positions,
          double* velocities, ScalarScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(step_scalar)(plan, first, forces, positions, velocities, scratch);
}

void fly(const ChainPlan& plan, const ReferenceMotion& reference, const double* initial,
         const double* launch_velocity, const FlightGains& gains, double* finals,
         double* tangents) {
  HWY_DYNAMIC_DISPATCH(fly_all)
  (plan, reference, initial, launch_velocity, gains, finals, tangents);
}

void fly_along(const ChainPlan& plan, const FlightState& start, double gain,
               const Directions& directions, std::span<const Index> samples,
               const Tangents& tangents) {
  assert(directions.count <= slopes());
  HWY_DYNAMIC_DISPATCH(fly_along_all)(plan, start, gain, directions, samples, tangents);
}

Index lanes() { return HWY_DYNAMIC_DISPATCH(lanes)(); }
Index slopes() { return HWY_DYNAMIC_DISPATCH(slopes)(); }
std::string instruction_set() { return HWY_DYNAMIC_DISPATCH(instruction_set)(); }

}  // namespace nuno::native
#endif  // HWY_ONCE
