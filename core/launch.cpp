#include <nuno/launch.h>

#include <nuno/reference_motion.h>

#include <cassert>
#include <cmath>

namespace nuno {
namespace {

/// φ(z) = (1 − e⁻ᶻ)/z.
double phi(double z) { return z == 0 ? 1 : -std::expm1(-z) / z; }

/// (1 − φ(z))/z = (z − 1 + e⁻ᶻ)/z², by its series where the difference would cancel.
double phi_complement(double z) {
  if (z > 0.5) return (1 - phi(z)) / z;
  double term = 0.5;
  double sum = term;
  for (int n = 3; std::abs(term) > 1e-17 * sum; ++n) {
    term *= -z / n;
    sum += term;
  }
  return sum;
}

}  // namespace

Points ballistic_launch(const Points& from, const Points& to, double arrival_time, double gravity,
                        double drag_rate) {
  const double z = drag_rate * arrival_time;
  Points velocities = (to - from) / (arrival_time * phi(z));
  velocities.row(1).array() += gravity * arrival_time * phi_complement(z) / phi(z);
  return velocities;
}

// The recurrence is affine in v₀ and g: x_n = x₀ + a·v₀ − b·g. Running it once for v₀ = 1, g = 0
// and once for v₀ = 0, g = −1 gives a and b with the engine's own rounding, at any drag.
Points ballistic_launch(const Points& from, const Points& to, double gravity,
                        const DragRecurrence& recurrence, Index steps) {
  double speed = 1, a = 0;
  double fall = 0, b = 0;
  for (Index n = 0; n < steps; ++n) {
    const double r = n == 0 ? recurrence.r1 : recurrence.r;
    const double q = n == 0 ? recurrence.q1 : recurrence.q;
    speed = r * speed;
    fall = r * fall + q;
    a += recurrence.h * speed;
    b += recurrence.h * fall;
  }
  Points velocities = (to - from) / a;
  velocities.row(1).array() += b * gravity / a;
  return velocities;
}

// Minimise ½·|u − v|² subject to tᵢ·(uᵢ₊₁ − uᵢ) = 0. With J the rows of these conditions,
// u = v − Jᵀλ where J·Jᵀ·λ = J·v: tridiagonal, 2 on the diagonal, −tᵢ·tᵢ₊₁ beside it.
Points without_stretching(const Points& positions, const Points& velocities) {
  const Index segments = positions.cols() - 1;
  Points tangent = positions.rightCols(segments) - positions.leftCols(segments);
  tangent.colwise().normalize();

  Vector upper(segments);  // Thomas algorithm
  Vector lambda(segments);
  for (Index i = 0; i < segments; ++i) {
    const double below = i > 0 ? -tangent.col(i - 1).dot(tangent.col(i)) : 0;
    const double above = i + 1 < segments ? -tangent.col(i).dot(tangent.col(i + 1)) : 0;
    const double stretching = tangent.col(i).dot(velocities.col(i + 1) - velocities.col(i));
    const double pivot = 2 - (i > 0 ? below * upper[i - 1] : 0);
    upper[i] = above / pivot;
    lambda[i] = (stretching - (i > 0 ? below * lambda[i - 1] : 0)) / pivot;
  }
  for (Index i = segments - 1; i-- > 0;) lambda[i] -= upper[i] * lambda[i + 1];

  Points result = velocities;
  for (Index i = 0; i < segments; ++i) {
    result.col(i) += lambda[i] * tangent.col(i);
    result.col(i + 1) -= lambda[i] * tangent.col(i);
  }
  return result;
}

Points launch(const Backend& backend) {
  const Problem& problem = backend.problem();
  Points velocities = ballistic_launch(problem.chain.initial, problem.target, problem.chain.gravity,
                                       backend.drag_recurrence(), backend.steps());
  const ReferenceMotion motion(problem, backend.time_step());
  if (motion.moves()) {
    velocities = motion.velocity().colwise() + centroid(velocities);
  } else {
    velocities += motion.velocity();  // of what it aims aside
  }
  return problem.launch == Launch::inextensible
             ? without_stretching(problem.chain.initial, velocities)
             : velocities;
}

}  // namespace nuno
