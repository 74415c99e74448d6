#include <nuno/launch.h>

#include <nuno/reference_motion.h>

#include <Eigen/SparseCholesky>
#include <cassert>
#include <cmath>
#include <vector>

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

// Minimise ½·Σ mᵢ·|uᵢ − vᵢ|² subject to J·u = 0, J the rows of tₑ·(u_b − u_a): u = v − M⁻¹Jᵀλ with
// J·M⁻¹·Jᵀ·λ = J·v. A flat sheet has more edges than its plane has ways to move, so the matrix is
// singular; a trace on its diagonal picks the least λ, and a second pass takes away what that left.
Points without_stretching(const Cloth& cloth, const Points& positions, const Points& velocities) {
  const Index d = positions.rows(), edges = cloth.edges.cols();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(2 * d * edges));
  for (Index e = 0; e < edges; ++e) {
    const Index a = cloth.edges(0, e), b = cloth.edges(1, e);
    const Vector along = (positions.col(b) - positions.col(a)).normalized();
    for (Index row = 0; row < d; ++row) {
      entries.emplace_back(e, d * a + row, -along[row]);
      entries.emplace_back(e, d * b + row, along[row]);
    }
  }
  Eigen::SparseMatrix<double> jacobian(edges, d * positions.cols());
  jacobian.setFromTriplets(entries.begin(), entries.end());
  const Vector inverse_mass =
      cloth.relative_mass.cwiseInverse().transpose().replicate(d, 1).reshaped();
  const Eigen::SparseMatrix<double> spread = inverse_mass.asDiagonal() * jacobian.transpose();
  Eigen::SparseMatrix<double> system = jacobian * spread;
  constexpr double trace = 1e-10;
  for (Index e = 0; e < edges; ++e) system.coeffRef(e, e) *= 1 + trace;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(system);
  Vector u = velocities.reshaped();
  for (int pass = 0; pass < 2; ++pass) u -= spread * factor.solve(jacobian * u);
  return u.reshaped(d, positions.cols());
}

Points without_stretching(const Problem& problem, const Points& velocities) {
  const Cloth& cloth = problem.cloth();
  return problem.is_sheet() ? without_stretching(cloth, cloth.initial, velocities)
                            : without_stretching(cloth.initial, velocities);
}

Points launch(const Backend& backend) {
  const Problem& problem = backend.problem();
  const Cloth& cloth = problem.cloth();
  Points velocities = ballistic_launch(cloth.initial, problem.target, cloth.gravity,
                                       backend.drag_recurrence(), backend.steps());
  const ReferenceMotion motion(problem, backend.time_step());
  if (motion.moves()) {
    velocities = motion.velocity().colwise() + cloth.mass_center(velocities);
  } else {
    velocities += motion.velocity();  // of the correction
  }
  return problem.launch == Launch::inextensible ? without_stretching(problem, velocities)
                                                : velocities;
}

// Without stretching, velocities are P·v with P = 1 − M⁻¹JᵀA⁻¹J, whose transpose is M·P·M⁻¹, since
// A is symmetric; two passes are its square.
std::vector<Points> correction_cotangents(const Problem& problem, std::vector<Points> by_offsets,
                                          const Points& by_launch) {
  const Vector& mass = problem.cloth().relative_mass;
  const auto times = [](const Points& points, const Vector& factors) -> Points {
    return points.array().rowwise() * factors.transpose().array();
  };
  const Points by_rate =
      problem.launch == Launch::inextensible
          ? times(without_stretching(problem, times(by_launch, mass.cwiseInverse())), mass)
          : by_launch;
  const CorrectionShares rates = correction_rates_at_start(problem.arrival_time);
  const double particles = static_cast<double>(mass.size());
  for (std::size_t k = 0; k < by_offsets.size(); ++k) {
    Points& offset = by_offsets[k];
    if (rates[k] != 0) offset += rates[k] * by_rate;
    // The transpose of shape_of.
    offset -= offset.rowwise().sum() * (mass / particles).transpose();
  }
  return by_offsets;
}

}  // namespace nuno
