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
//     (2 + ℓ/(c⁺p))·τᵢ − cosθᵢ₊₁·τᵢ₊₁ − cosθᵢ·τᵢ₋₁ = u*ᵢ + (EA/c⁺)·(lᵢ − ℓᵢ) + (c⁻/c⁺)·uᵢ,
// where τ = p·T, eliminated on the way up the chain and substituted on the way down.

#if defined(NUNO_CHAIN_STEP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NUNO_CHAIN_STEP_INL_H_
#undef NUNO_CHAIN_STEP_INL_H_
#else
#define NUNO_CHAIN_STEP_INL_H_
#endif

#include "chain_kernel.h"

#include <hwy/highway.h>
#include "implicit_hinges-inl.h"
#include "vector-inl.h"

#include <algorithm>
#include <memory>

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {

/// A segment on the way up: first what it is, then its row of the eliminated system.
template <typename T>
struct Segment {
  Vec2<T> direction;
  T offset;  ///< first what strain and old rate put on the right; then τᵢ = offset + factor·τᵢ₊₁
  T factor;  ///< first cosθᵢ of the hinge below
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

/// Moves a particle with its new velocity and adds it to the sums, which are always made from the
/// last particle on.
template <bool damped_control, typename T>
HWY_INLINE void move_particle(const ChainPlan& plan, Index i, Vec2<T> velocity, Vec2<T>* x,
                              Vec2<T>* v, Sums<T>& sums) {
  v[i] = velocity;
  x[i] = {scale_add(plan.h, velocity.x, x[i].x), scale_add(plan.h, velocity.y, x[i].y)};
  sums.position = sums.position + x[i];
  if constexpr (damped_control) sums.velocity = sums.velocity + velocity;
}

/// On the way down: substitutes, adds the tensions to the kick and moves through `set(i, v')`.
template <typename T, typename Set>
HWY_INLINE void go_down(const ChainPlan& plan, const Vec2<T>* v, const Segment<T>* segments,
                        Set&& set) {
  const T zero = Constant<T>::of(0);
  Vec2<T> pulled = v[plan.particles - 1];  // by the segment above
  T tension = zero;                        // τ
  for (Index i = plan.particles - 1; i-- > 0;) {
    const Segment<T> s = segments[i];
    tension = mul_add(s.factor, tension, s.offset);
    set(i + 1, {neg_mul_add(tension, s.direction.x, pulled.x),
                neg_mul_add(tension, s.direction.y, pulled.y)});
    pulled = {mul_add(tension, s.direction.x, v[i].x), mul_add(tension, s.direction.y, v[i].y)};
  }
  set(0, pulled);
}

/// What a step works on besides the state: of explicit hinges or of implicit ones.
template <typename T>
struct Scratch {
  Segment<T>* segments = nullptr;
  StiffSegment<T>* stiff_segments = nullptr;
  StiffDerivative<T>* derivatives = nullptr;
};

/// Memory for it, as much as the plan's hinges need.
template <typename T>
class OwnScratch {
 public:
  explicit OwnScratch(const ChainPlan& plan) {
    const auto size = static_cast<std::size_t>(plan.particles);
    if (!plan.implicit_hinges) {
      segments_.reset(new Segment<T>[size]);
    } else {
      stiff_segments_.reset(new StiffSegment<T>[size]);
      if constexpr (has_derivative<T>) derivatives_.reset(new StiffDerivative<T>[size]);
    }
  }
  Scratch<T> parts() const { return {segments_.get(), stiff_segments_.get(), derivatives_.get()}; }

 private:
  std::unique_ptr<Segment<T>[]> segments_;
  std::unique_ptr<StiffSegment<T>[]> stiff_segments_;
  std::unique_ptr<StiffDerivative<T>[]> derivatives_;
};

/// One step. `external(j, x, v)` is the force on particle j; returns the sums after the step.
template <bool damped_control, typename T, typename External>
HWY_INLINE Sums<T> advance(const ChainPlan& plan, bool first, Vec2<T>* x, Vec2<T>* v,
                           const Scratch<T>& scratch, External&& external) {
  const ChainPlan::Kick& kick = first ? plan.first : plan.full;
  const T zero = Constant<T>::of(0);
  Sums<T> sums{{zero, zero}, {zero, zero}};
  const auto set = [&](Index i, Vec2<T> velocity) NUNO_INLINE_LAMBDA {
    move_particle<damped_control>(plan, i, velocity, x, v, sums);
  };
  if (plan.implicit_hinges) {
    go_up_stiff(plan, kick, x, v, scratch.stiff_segments, scratch.derivatives, external);
    if constexpr (has_derivative<T>) {
      go_down_stiff(plan, v, scratch.stiff_segments,
                    [&](Index i, Vec2<T> velocity) NUNO_INLINE_LAMBDA { v[i] = velocity; });
      solve_derivatives(plan, v, scratch.stiff_segments, scratch.derivatives);
      for (Index i = plan.particles; i-- > 0;) set(i, v[i]);
    } else {
      go_down_stiff(plan, v, scratch.stiff_segments, set);
    }
    return sums;
  }
  if (plan.hinge_dashpot.empty()) {
    go_up<false>(plan, kick, x, v, scratch.segments, external);
  } else {
    go_up<true>(plan, kick, x, v, scratch.segments, external);
  }
  go_down(plan, v, scratch.segments, set);
  return sums;
}

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
