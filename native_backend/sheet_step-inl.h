// The sheet's equations of motion, written once for every number (number-inl.h).
//
// Springs. Between particles i and j, l = |d|, d = xⱼ − xᵢ: the force k·(l − ℓ) + c·l̇ along d. The
// rate l̇ is that of the last substep, (l − l_before)/h, so that on i the force is
//     ((k + c/h) − (k·ℓ + c/h·l_before)/l)·d.
//
// Hinges. At the edge e = b − a between the triangles (a, b, c) and (b, a, d), with the normals
//     n₁ = e × (c − a),   n₂ = (d − a) × e,
// of twice the triangles' areas,
//     cos θ = n₁·n₂/(|n₁||n₂|),   sin θ = −|e|·n₁·(d − a)/(|n₁||n₂|)
// (the latter by (e × c) × (d × e) = −(e × c · d)·e). Angles are taken from the rest angle, by the
// sine and cosine of θ − θ₀, so that a hinge may pass θ = π. With M = k·(θ − θ₀) + c·θ̇ the forces
// −M·∂θ/∂x are
//     on c: G₁ = M·|e|/|n₁|²·n₁,   on d: G₂ = M·|e|/|n₂|²·n₂,
//     on b: −(t₁·G₁ + t₂·G₂),      on a: what makes the sum zero,
// where t₁ = (c − a)·e/e² and t₂ = (d − a)·e/e² tell the feet of c and d on the edge.
//
// Scheme. Leapfrog with multiple time steps: a step H of the hinges and the control has n substeps
// h = H/n of the springs, whose frequency is far higher and whose force is far cheaper. Positions
// at whole substeps, velocities at half ones,
//     v' = r·v − q·g + (q/m)·f,   x' = x + h·v',   r = e^(−κh), q = (1 − r)/κ,
// where f has the springs in every substep and n times the slow forces in the first of a step: they
// kick for all of the step at once (the impulse method, Verlet-I or r-RESPA: Grubmüller et al.
// 1991, Tuckerman et al. 1992). Second order, symmetric in time, exact for gravity and drag; the
// first kick starts from the launch velocity at t = 0, so it is half as long.
//
// What is stored is u = m·v/q, so that forces add to it as they are. A pass over the particles does
// a substep: a particle's springs to those after it give the last of its force, so it is moved at
// once, and u goes on to r·u − m·g, ready for the next kick.
//
// Velocities. What control is told is the mean velocity over the last step, as the trapezoid
//     ½·(1 + 1/n)·w_end + ½·(1 − 1/n)·w_kicked
// of the velocity w of the last substep and that of the substep before the step, to which the kick
// of all the step is added: centred and of second order like (x − x_before)/H, which it is where
// n = 1. A stretch wave of frequency ω that a step does not resolve gets from control's dashpots β
// the power −β·(½·(1 + cos ωH) + …) ≤ 0. With (x − x_before)/H it would be −β·sin(ωH)/(ωH), which
// pumps at π < ωH < 2π: then a sheet of 1024 particles without damping of its own tore at gains
// that half of the step took well.

#if defined(NUNO_SHEET_STEP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NUNO_SHEET_STEP_INL_H_
#undef NUNO_SHEET_STEP_INL_H_
#else
#define NUNO_SHEET_STEP_INL_H_
#endif

#include "sheet_kernel.h"

#include <hwy/highway.h>
#include "number-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {

template <typename T>
struct Vec3 {
  T x, y, z;
};
template <typename T>
HWY_INLINE Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename T>
HWY_INLINE Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename T>
HWY_INLINE Vec3<T> operator*(const T& a, const Vec3<T>& b) {
  return {a * b.x, a * b.y, a * b.z};
}
template <typename T>
HWY_INLINE T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return mul_add(a.x, b.x, mul_add(a.y, b.y, a.z * b.z));
}
template <typename T>
HWY_INLINE Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {neg_mul_add(a.z, b.y, a.y * b.z), neg_mul_add(a.x, b.z, a.z * b.x),
          neg_mul_add(a.y, b.x, a.x * b.y)};
}
/// c + a·b
template <typename T>
HWY_INLINE Vec3<T> add_scaled(const T& a, const Vec3<T>& b, const Vec3<T>& c) {
  return {mul_add(a, b.x, c.x), mul_add(a, b.y, c.y), mul_add(a, b.z, c.z)};
}
/// c − a·b
template <typename T>
HWY_INLINE Vec3<T> subtract_scaled(const T& a, const Vec3<T>& b, const Vec3<T>& c) {
  return {neg_mul_add(a, b.x, c.x), neg_mul_add(a, b.y, c.y), neg_mul_add(a, b.z, c.z)};
}
/// c + a·b with a constant a
template <typename T>
HWY_INLINE Vec3<T> scale_add(double a, const Vec3<T>& b, const Vec3<T>& c) {
  return {scale_add(a, b.x, c.x), scale_add(a, b.y, c.y), scale_add(a, b.z, c.z)};
}
template <typename T>
HWY_INLINE Vec3<T> scale(double a, const Vec3<T>& b) {
  return {scale(a, b.x), scale(a, b.y), scale(a, b.z)};
}

/// An angle between −2π and 2π, turned into [−π, π].
template <typename T>
HWY_INLINE T within_half_turn(T angle) {
  const T pi(3.141592653589793), turn(6.283185307179586);
  const T lower = where_greater(angle, pi, angle - turn, angle);
  return where_greater(T(0.0) - pi, lower, lower + turn, lower);
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> within_half_turn(Dual<T, S> angle) {
  return {within_half_turn(angle.value), angle.derivative};
}

/// The numbers of a sheet in flight, see SheetState.
template <typename T>
struct SheetArrays {
  Vec3<T>* x;
  Vec3<T>* u;
  T* length;
  T* turn;
  Vec3<T>* velocity;  ///< null where nobody asks
};

/// The velocity of the last substep of a particle with this u.
template <typename T>
HWY_INLINE Vec3<T> velocity_of(const SheetPlan& plan, Index i, const Vec3<T>& u) {
  const auto at = static_cast<std::size_t>(i);
  return scale(plan.speed[at], Vec3<T>{u.x, shift(plan.weight[at], u.y), u.z});
}

/// A substep: the springs kick for `share` of a full kick, and all move.
template <bool damped, bool whole, typename T>
HWY_INLINE void spring_substep(const SheetPlan& plan, double share, const SheetArrays<T>& sheet) {
  const Index* far_end = plan.far_end.data();
  const double* spring = plan.spring.data();
  const double* rest_tension = plan.rest_tension.data();
  const double* dashpot = plan.dashpot.data();
  Index e = 0;
  for (Index i = 0; i < plan.particles; ++i) {
    const Vec3<T> x = sheet.x[i];
    Vec3<T> u = sheet.u[i];
    for (const Index end = plan.first_spring[static_cast<std::size_t>(i + 1)]; e < end; ++e) {
      const Index j = far_end[e];
      const Vec3<T> d = sheet.x[j] - x;
      const T squared = dot(d, d);
      const T inverse = rsqrt(squared);
      T rest = Constant<T>::of(rest_tension[e]);
      if constexpr (damped) {
        rest = scale_add(dashpot[e], sheet.length[e], rest);
        sheet.length[e] = squared * inverse;
      }
      T pull = neg_mul_add(rest, inverse, Constant<T>::of(spring[e]));
      if constexpr (!whole) pull = scale(share, pull);
      u = add_scaled(pull, d, u);
      sheet.u[j] = subtract_scaled(pull, d, sheet.u[j]);
    }
    sheet.x[i] = scale_add(plan.move[static_cast<std::size_t>(i)], u, x);
    sheet.u[i] = {scale(plan.keep, u.x),
                  shift(-plan.weight[static_cast<std::size_t>(i)], scale(plan.keep, u.y)),
                  scale(plan.keep, u.z)};
  }
}

/// A hinge's geometry at some positions.
template <typename T>
struct HingeShape {
  Vec3<T> n1, n2;
  T g1, g2;  ///< |e|/|n₁|², |e|/|n₂|²
  T t1, t2;
  T turn;  ///< θ − θ₀

  /// A rest angle for all lanes (double) or of each its own (Pack).
  template <typename C>
  HWY_INLINE HingeShape(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c, const Vec3<T>& d,
                        C rest_cosine, C rest_sine) {
    const Vec3<T> e = b - a, to_c = c - a, to_d = d - a;
    n1 = cross(e, to_c);
    n2 = cross(to_d, e);
    const T squared = dot(e, e), one = dot(n1, n1), two = dot(n2, n2);
    const T inverse = rsqrt(squared);
    const T length = squared * inverse;
    const T w = rsqrt(one * two);
    const T cosine = w * dot(n1, n2);
    const T negative_sine = (w * length) * dot(n1, to_d);
    // Of θ − θ₀.
    turn = angle(neg_add(scale(rest_cosine, negative_sine), scale(rest_sine, cosine)),
                 scale_add(rest_cosine, cosine, scale(-rest_sine, negative_sine)));
    const T scaled = length * (w * w);
    g1 = scaled * two;
    g2 = scaled * one;
    const T per_square = inverse * inverse;
    t1 = per_square * dot(to_c, e);
    t2 = per_square * dot(to_d, e);
  }

  /// −a − b
  static HWY_INLINE T neg_add(T a, T b) { return (Constant<T>::of(0) - a) - b; }
};

/// The forces of a hinge on its corners.
template <typename T>
struct HingeForces {
  Vec3<T> a, minus_b, c, d;

  HWY_INLINE HingeForces(const HingeShape<T>& shape, const T& moment) {
    c = (moment * shape.g1) * shape.n1;
    d = (moment * shape.g2) * shape.n2;
    minus_b = add_scaled(shape.t1, c, shape.t2 * d);
    a = minus_b - (c + d);
  }
};

template <bool damped, typename T>
HWY_INLINE void hinge_kick_of(const SheetPlan& plan, double kicks, const SheetArrays<T>& sheet) {
  const Index* corners = plan.corners.data();
  for (Index h = 0; h < plan.hinges(); ++h, corners += 4) {
    const auto at = static_cast<std::size_t>(h);
    const Index a = corners[0], b = corners[1], c = corners[2], d = corners[3];
    const HingeShape<T> shape(sheet.x[a], sheet.x[b], sheet.x[c], sheet.x[d], plan.rest_cosine[at],
                              plan.rest_sine[at]);
    T moment = scale(kicks * plan.hinge_spring[at], shape.turn);
    if constexpr (damped) {
      moment = scale_add(kicks * plan.hinge_dashpot[at],
                         within_half_turn(shape.turn - sheet.turn[h]), moment);
      sheet.turn[h] = shape.turn;
    }
    const HingeForces<T> on(shape, moment);
    sheet.u[a] = sheet.u[a] + on.a;
    sheet.u[b] = sheet.u[b] - on.minus_b;
    sheet.u[c] = sheet.u[c] + on.c;
    sheet.u[d] = sheet.u[d] + on.d;
  }
}

/// The hinges kick for `kicks` of a full kick of a substep.
template <typename T>
HWY_INLINE void hinge_kick(const SheetPlan& plan, double kicks, const SheetArrays<T>& sheet) {
  if (plan.hinge_dashpot.empty()) {
    hinge_kick_of<false>(plan, kicks, sheet);
  } else {
    hinge_kick_of<true>(plan, kicks, sheet);
  }
}

/// How much of the velocity that control is told is that of a step's last substep.
HWY_INLINE double end_share(const SheetPlan& plan) {
  return 0.5 + 0.5 / static_cast<double>(plan.substeps);
}

/// How much of a full kick of a substep the slow forces give in a step.
HWY_INLINE double kicks_of_step(const SheetPlan& plan, bool first) {
  return (first ? plan.first_share : 1) * static_cast<double>(plan.substeps);
}

/// The slow forces of a step: `external(i)`, that on particle i of the plan's order, and what
/// `hinges` kick.
template <typename T, typename External, typename Hinges>
HWY_INLINE void slow_kick(const SheetPlan& plan, bool first, const SheetArrays<T>& sheet,
                          External&& external, Hinges&& hinges) {
  const double kicks = kicks_of_step(plan, first);
  for (Index i = 0; i < plan.particles; ++i) {
    sheet.u[i] = scale_add(kicks, external(i), sheet.u[i]);
  }
  hinges(plan, kicks, sheet);
  if (sheet.velocity == nullptr) return;
  for (Index i = 0; i < plan.particles; ++i) {
    sheet.velocity[i] = scale(1 - end_share(plan), velocity_of(plan, i, sheet.u[i]));
  }
}

/// The substeps of a step after its slow kick. `before(n)` is called before substep n.
template <typename T, typename Before>
HWY_INLINE void spring_substeps(const SheetPlan& plan, bool first, const SheetArrays<T>& sheet,
                                Before&& before) {
  for (Index n = 0; n < plan.substeps; ++n) {
    before(n);
    if (plan.dashpot.empty()) {
      if (n == 0 && first) {
        spring_substep<false, false>(plan, plan.first_share, sheet);
      } else {
        spring_substep<false, true>(plan, 1, sheet);
      }
    } else if (n == 0 && first) {
      spring_substep<true, false>(plan, plan.first_share, sheet);
    } else {
      spring_substep<true, true>(plan, 1, sheet);
    }
  }
  if (sheet.velocity == nullptr) return;
  for (Index i = 0; i < plan.particles; ++i) {
    sheet.velocity[i] =
        scale_add(end_share(plan), velocity_of(plan, i, sheet.u[i]), sheet.velocity[i]);
  }
}

/// One step. `external(i)` is the force on particle i of the plan's order.
template <typename T, typename External>
HWY_INLINE void advance_sheet(const SheetPlan& plan, bool first, const SheetArrays<T>& sheet,
                              External&& external) {
  slow_kick(plan, first, sheet, external, hinge_kick<T>);
  spring_substeps(plan, first, sheet, [](Index) {});
}

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
