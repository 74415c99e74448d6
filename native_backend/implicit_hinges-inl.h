// A step of a chain whose hinges are implicit too, for those that would force an explicit step far
// below what the motion needs (chain_step-inl.h has the notation and the explicit hinges).
//
// Scheme. Each tension and each moment is taken from a mean of three lengths or angles, s = l − ℓ
// or θ: b·s₊ + (1 − 2b)·s + b·s₋, b = ¼ or 0.3, and its dashpot from the mean of two rates,
//     Q = K·s + c⁺·ṡ' + c⁻·ṡ,   c⁺ = K·b·h + η/2,   c⁻ = −K·b·h + η/2,   ṡ = g·v,
// g the gradient of s over the particles and v' the new velocities. Of second order, undamped, and
// h²ω² becomes h²ω²/(1 + b·h²ω²) < 1/b: below the leapfrog's 4 at every stiffness. With b = ¼ for
// the moments too, which comes up to that limit, unresolved waves grow and 1000 particles burst.
//
// With τ = p·Q for all of them and v' = v* − Σ τ·g, where v* is what all other forces make of v,
//     τ/(p·c⁺) + g·Σ τ·g = g·v* + (K/c⁺)·s + (c⁻/c⁺)·ṡ,
// symmetric and positive definite. Segment i changes its length by ±tᵢ at its ends, its direction
// by ±aᵢ, aᵢ = nᵢ/lᵢ. In the order M₁ T₁ M₂ T₂ …, hinge i before segment i, with C and S cosine and
// sine of a hinge's angle, Iᵢ = 1/lᵢ and Pᵢ = Cᵢ·Iᵢ·Iᵢ₋₁, the rows below the diagonal are
//     Mᵢ:  Pᵢ₋₁ (Mᵢ₋₂),  −Iᵢ₋₁·Sᵢ₋₁ (Tᵢ₋₂),  −2Iᵢ₋₁² − Pᵢ₋₁ − Pᵢ (Mᵢ₋₁),  Iᵢ·Sᵢ (Tᵢ₋₁)
//     Tᵢ:                 −Iᵢ₋₁·Sᵢ (Mᵢ₋₁),       −Cᵢ (Tᵢ₋₁),               Iᵢ₋₁·Sᵢ (Mᵢ)
// and the diagonals 2(Iᵢ² + Iᵢ₋₁² + Pᵢ) and 2 more than 1/(p·c⁺). It is factored as L·D·Lᵀ on the
// way up the chain and substituted on the way down, a chain's length in time. Derivatives take the
// same factors once more.

#if defined(NUNO_IMPLICIT_HINGES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NUNO_IMPLICIT_HINGES_INL_H_
#undef NUNO_IMPLICIT_HINGES_INL_H_
#else
#define NUNO_IMPLICIT_HINGES_INL_H_
#endif

#include "chain_kernel.h"

#include <hwy/highway.h>
#include "vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {

/// A row of L, by distance from the diagonal, and what it made of the right side, over D.
template <typename T>
struct MomentRow {
  T l1, l2, l3, l4, value;
};
template <typename T>
struct TensionRow {
  T l1, l2, l3, value;
};

/// A segment and the hinge at its lower end, on the way up.
template <typename T>
struct StiffSegment {
  using Value = typename Constant<T>::Value;
  Vec2<T> direction;
  T inverse;  ///< Iᵢ
  MomentRow<Value> moment;
  TensionRow<Value> tension;
};

/// What a segment's derivatives need besides; empty for a number without them.
template <typename T>
struct StiffDerivative {};
template <typename T, typename S>
struct StiffDerivative<Dual<T, S>> {
  T moment_inverse, tension_inverse;  ///< 1/D
  /// First what the right side has of old places and velocities; then see MomentRow::value.
  S moment, tension;
};

/// What the elimination of a row needs of the two blocks below.
template <typename T>
struct Eliminated {
  MomentRow<T> moment;  ///< value: of the right side, not yet over D
  TensionRow<T> tension;
  T moment_inverse, tension_inverse;  ///< 1/D

  static HWY_INLINE Eliminated nothing() {
    const T zero = Constant<T>::of(0);
    return {{zero, zero, zero, zero, zero}, {zero, zero, zero, zero}, zero, zero};
  }
};

/// A hinge and its segments: the entries of the matrix above.
template <typename T>
struct HingeEntries {
  T cosine, sine;
  T product;  ///< P
  T inverse;  ///< I of the segment above
};

/// Row M. `below` is the hinge below this one.
template <typename T>
HWY_INLINE void eliminate_moment(const HingeEntries<T>& hinge, const HingeEntries<T>& below,
                                 double compliance, T right, const Eliminated<T>& two_below,
                                 const Eliminated<T>& one_below, Eliminated<T>& row) {
  const T lower = below.inverse * below.inverse;
  const T zero = Constant<T>::of(0);
  const T c4 = below.product;
  const T c3 = neg_mul_add(c4, two_below.tension.l1, neg_mul_add(below.inverse, below.sine, zero));
  const T a2 = zero - (scale(2, lower) + below.product + hinge.product);
  const T c2 = neg_mul_add(c3, one_below.moment.l1, neg_mul_add(c4, one_below.moment.l2, a2));
  const T a1 = hinge.inverse * hinge.sine;
  const T c1 =
      neg_mul_add(c2, one_below.tension.l1,
                  neg_mul_add(c3, one_below.tension.l2, neg_mul_add(c4, one_below.tension.l3, a1)));
  MomentRow<T>& l = row.moment;
  l.l4 = c4 * two_below.moment_inverse;
  l.l3 = c3 * two_below.tension_inverse;
  l.l2 = c2 * one_below.moment_inverse;
  l.l1 = c1 * one_below.tension_inverse;
  const T diagonal = scale_add(2, mul_add(hinge.inverse, hinge.inverse, lower + hinge.product),
                               Constant<T>::of(compliance));
  const T pivot = neg_mul_add(
      c1, l.l1, neg_mul_add(c2, l.l2, neg_mul_add(c3, l.l3, neg_mul_add(c4, l.l4, diagonal))));
  row.moment_inverse = reciprocal(pivot);
  l.value = neg_mul_add(l.l1, one_below.tension.value,
                        neg_mul_add(l.l2, one_below.moment.value,
                                    neg_mul_add(l.l3, two_below.tension.value,
                                                neg_mul_add(l.l4, two_below.moment.value, right))));
}

/// Row T, of the segment above `hinge`; `lower` is I of the segment below it.
template <typename T>
HWY_INLINE void eliminate_tension(const HingeEntries<T>& hinge, T lower, double compliance, T right,
                                  const Eliminated<T>& one_below, Eliminated<T>& row) {
  const T zero = Constant<T>::of(0);
  const T a1 = lower * hinge.sine;
  const T c3 = zero - a1;
  const T c2 = neg_mul_add(c3, one_below.tension.l1, zero - hinge.cosine);
  const T c1 = neg_mul_add(c2, row.moment.l1, neg_mul_add(c3, row.moment.l2, a1));
  TensionRow<T>& l = row.tension;
  l.l3 = c3 * one_below.moment_inverse;
  l.l2 = c2 * one_below.tension_inverse;
  l.l1 = c1 * row.moment_inverse;
  const T pivot = neg_mul_add(
      c1, l.l1, neg_mul_add(c2, l.l2, neg_mul_add(c3, l.l3, Constant<T>::of(2 + compliance))));
  row.tension_inverse = reciprocal(pivot);
  l.value = neg_mul_add(
      l.l1, row.moment.value,
      neg_mul_add(l.l2, one_below.tension.value, neg_mul_add(l.l3, one_below.moment.value, right)));
}

/// A segment before the kick.
template <typename T>
struct SegmentMotion {
  Vec2<T> direction;
  T inverse, spin;        ///< 1/l, φ̇
  T stretch, stretching;  ///< l − ℓ and its rate
};
template <typename T>
HWY_INLINE SegmentMotion<T> motion_of(Vec2<T> span, Vec2<T> rate, double rest_length) {
  const T squared = dot(span, span);
  const T inverse = rsqrt(squared);
  const Vec2<T> t = inverse * span;
  return {t, inverse, cross(t, rate) * inverse, shift(-rest_length, squared * inverse),
          dot(t, rate)};
}

/// On the way up: kicks with the external forces and eliminates tensions and moments.
template <typename T, typename External>
HWY_INLINE void go_up_stiff(const ChainPlan& plan, const ChainPlan::Kick& kick, const Vec2<T>* x,
                            Vec2<T>* v, StiffSegment<T>* segments, StiffDerivative<T>* derivatives,
                            External&& external) {
  using Value = typename Constant<T>::Value;
  const Index n = plan.particles;
  const T zero = Constant<T>::of(0);
  const Value none = Constant<Value>::of(0);
  const auto kick_particle = [&](Index i) NUNO_INLINE_LAMBDA {
    const Vec2<T> force = external(i, x[i], v[i]);
    v[i] = {scale_add(kick.force, force.x, scale(kick.keep, v[i].x)),
            scale_add(kick.force, force.y, shift(-kick.fall, scale(kick.keep, v[i].y)))};
  };
  Eliminated<Value> two_below = Eliminated<Value>::nothing(), one_below = two_below;
  HingeEntries<Value> hinge_below{none, none, none, none};
  Vec2<T> direction_below{zero, zero};
  T spin_below = zero;      // φ̇ of the old velocities,
  Value turn_below = none;  // of the kicked ones
  Vec2<T> old_below = v[0];
  kick_particle(0);
  for (Index i = 0; i + 1 < n; ++i) {
    const Vec2<T> old_above = v[i + 1];
    const auto [t, inverse, spin, stretch, stretching] = motion_of(
        x[i + 1] - x[i], old_above - old_below, plan.rest_length[static_cast<std::size_t>(i)]);
    kick_particle(i + 1);
    const Vec2<Value> kicked = value_of(v[i + 1]) - value_of(v[i]);
    const Value turn = cross(value_of(t), kicked) * value_of(inverse);
    const Value strain =
        scale_add(kick.strain, value_of(stretch),
                  scale_add(kick.rate, value_of(stretching), dot(value_of(t), kicked)));

    const T cosine = dot(direction_below, t), sine = cross(direction_below, t);
    const HingeEntries<Value> hinge{value_of(cosine), value_of(sine),
                                    value_of(cosine) * value_of(inverse) * hinge_below.inverse,
                                    value_of(inverse)};
    Eliminated<Value> row = Eliminated<Value>::nothing();
    T bend = zero, bending = zero;
    if (i > 0) {
      bend = angle(sine, cosine);
      bending = spin - spin_below;
      const Value right =
          scale_add(kick.hinge_strain, value_of(bend),
                    scale_add(kick.hinge_rate, value_of(bending), turn - turn_below));
      eliminate_moment(hinge, hinge_below,
                       kick.hinge_compliance * plan.hinge_length[static_cast<std::size_t>(i - 1)],
                       right, two_below, one_below, row);
    }
    eliminate_tension(hinge, hinge_below.inverse,
                      kick.compliance * plan.rest_length[static_cast<std::size_t>(i)], strain,
                      one_below, row);
    StiffSegment<T>& s = segments[i];
    s = {t, inverse, row.moment, row.tension};
    s.moment.value = row.moment.value * row.moment_inverse;
    s.tension.value = row.tension.value * row.tension_inverse;
    if constexpr (has_derivative<T>) {
      derivatives[i] = {
          row.moment_inverse, row.tension_inverse,
          scale_add(kick.hinge_strain, bend, scale(kick.hinge_rate, bending)).derivative,
          scale_add(kick.strain, stretch, scale(kick.rate, stretching)).derivative};
    }

    two_below = one_below;
    one_below = row;
    hinge_below = hinge;
    direction_below = t;
    spin_below = spin;
    turn_below = turn;
    old_below = old_above;
  }
}

/// The substitution on the way down, of τ or of its derivatives (T), a segment and the hinge at its
/// lower end at a time. Value is the number of L.
template <typename Value, typename T>
struct BackSubstitution {
  // τ of the hinge and segment above and of the hinge above those; the rows of L that lead there.
  T moment_1, tension_1, moment_2;
  MomentRow<Value> moments_1, moments_2;
  TensionRow<Value> tensions_1;

  struct Found {
    T tension;
    T moment_difference;  ///< from the hinge above
  };

  static HWY_INLINE BackSubstitution begin() {
    const T zero(0.0);
    const Value none(0.0);
    const MomentRow<Value> row{none, none, none, none, none};
    return {zero, zero, zero, row, row, {none, none, none, none}};
  }

  HWY_INLINE Found next(const MomentRow<Value>& moments, const TensionRow<Value>& tensions,
                        T moment_value, T tension_value) {
    const T tension = neg_mul_add(
        moments_1.l1, moment_1,
        neg_mul_add(tensions_1.l2, tension_1, neg_mul_add(moments_2.l3, moment_2, tension_value)));
    const T moment =
        neg_mul_add(tensions.l1, tension,
                    neg_mul_add(moments_1.l2, moment_1,
                                neg_mul_add(tensions_1.l3, tension_1,
                                            neg_mul_add(moments_2.l4, moment_2, moment_value))));
    const Found found{tension, moment - moment_1};
    moment_2 = moment_1;
    moment_1 = moment;
    tension_1 = tension;
    moments_2 = moments_1;
    moments_1 = moments;
    tensions_1 = tensions;
    return found;
  }
};

/// On the way down: substitutes and adds tensions and moments to the kick, through `set(i, v')`.
/// Derivatives are those at constant τ.
template <typename T, typename Set>
HWY_INLINE void go_down_stiff(const ChainPlan& plan, const Vec2<T>* v,
                              const StiffSegment<T>* segments, Set&& set) {
  using Value = typename Constant<T>::Value;
  auto above = BackSubstitution<Value, Value>::begin();
  Vec2<T> pulled = v[plan.particles - 1];  // by the segment above
  for (Index i = plan.particles - 1; i-- > 0;) {
    const StiffSegment<T>& s = segments[i];
    const auto found = above.next(s.moment, s.tension, s.moment.value, s.tension.value);
    const T shear = scale(found.moment_difference, s.inverse);
    const Vec2<T> pull{neg_mul_add(shear, s.direction.y, scale(found.tension, s.direction.x)),
                       mul_add(shear, s.direction.x, scale(found.tension, s.direction.y))};
    set(i + 1, pulled - pull);
    pulled = v[i] + pull;
  }
  set(0, pulled);
}

/// The derivatives of τ: the system's own, differentiated, with u = v* − Σ τ·g at constant τ,
///     A·dτ = d(g·u) + d((K/c⁺)·s + (c⁻/c⁺)·ṡ),
/// solved with the L·D·Lᵀ of A. Up and down once more, and no factor is differentiated.
template <typename T, typename S>
HWY_INLINE void solve_derivatives(const ChainPlan& plan, Vec2<Dual<T, S>>* v,
                                  const StiffSegment<Dual<T, S>>* segments,
                                  StiffDerivative<Dual<T, S>>* derivatives) {
  using Number = Dual<T, S>;
  const Index n = plan.particles;
  const S zero(0.0);
  S moment_1 = zero, moment_2 = zero, tension_1 = zero, tension_2 = zero;  // of the rows below
  S turn_below = zero;
  for (Index i = 0; i + 1 < n; ++i) {
    const StiffSegment<Number>& s = segments[i];
    StiffDerivative<Number>& own = derivatives[i];
    const Vec2<Number> rate = v[i + 1] - v[i];
    const S turn = (cross(s.direction, rate) * s.inverse).derivative;
    const S moment = neg_mul_add(
        s.moment.l1, tension_1,
        neg_mul_add(
            s.moment.l2, moment_1,
            neg_mul_add(s.moment.l3, tension_2,
                        neg_mul_add(s.moment.l4, moment_2, own.moment + (turn - turn_below)))));
    const S tension = neg_mul_add(
        s.tension.l1, moment,
        neg_mul_add(
            s.tension.l2, tension_1,
            neg_mul_add(s.tension.l3, moment_1, own.tension + dot(s.direction, rate).derivative)));
    own.moment = own.moment_inverse * moment;
    own.tension = own.tension_inverse * tension;
    turn_below = turn;
    moment_2 = moment_1;
    moment_1 = moment;
    tension_2 = tension_1;
    tension_1 = tension;
  }
  auto above = BackSubstitution<T, S>::begin();
  for (Index i = n - 1; i-- > 0;) {
    const StiffSegment<Number>& s = segments[i];
    const auto found =
        above.next(s.moment, s.tension, derivatives[i].moment, derivatives[i].tension);
    const S shear = s.inverse.value * found.moment_difference;
    const Vec2<T> t = value_of(s.direction);
    const Vec2<S> pull{neg_mul_add(t.y, shear, t.x * found.tension),
                       mul_add(t.x, shear, t.y * found.tension)};
    v[i + 1].x.derivative = v[i + 1].x.derivative - pull.x;
    v[i + 1].y.derivative = v[i + 1].y.derivative - pull.y;
    v[i].x.derivative = v[i].x.derivative + pull.x;
    v[i].y.derivative = v[i].y.derivative + pull.y;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
