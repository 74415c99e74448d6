#include <nuno/sheet_modes.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace nuno {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using SparseMatrix = Eigen::SparseMatrix<double>;

/// K. In a triangle of area A the hat function of corner i has the gradient eᵢ/2A, turned by a
/// right angle, where eᵢ is the edge across from it: the entry of i and j is eᵢ·eⱼ/4A.
SparseMatrix laplacian(const Sheet& sheet) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index t = 0; t < sheet.triangles.cols(); ++t) {
    const auto corners = sheet.triangles.col(t);
    Eigen::Matrix3d across;
    for (Index i = 0; i < 3; ++i) {
      across.col(i) =
          sheet.initial.col(corners[(i + 2) % 3]) - sheet.initial.col(corners[(i + 1) % 3]);
    }
    const double area = 0.5 * across.col(0).cross(across.col(1)).norm();
    const Eigen::Matrix3d products =
        sheet.triangle_weight[t] / (4 * area) * across.transpose() * across;
    for (Index i = 0; i < 3; ++i) {
      for (Index j = 0; j < 3; ++j) entries.emplace_back(corners[i], corners[j], products(i, j));
    }
  }
  SparseMatrix result(sheet.particles(), sheet.particles());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Vectors with a share of every mode: phases like those of sin(i²).
MatrixXd patterns(Index particles, Index count) {
  MatrixXd result(particles, count);
  for (Index j = 0; j < count; ++j) {
    for (Index i = 0; i < particles; ++i) {
      const double k = static_cast<double>(i + 1) + 0.37 * static_cast<double>(j);
      result(i, j) = std::sin(1.7 * k + (0.61803 + 0.1 * static_cast<double>(j)) * k * k);
    }
  }
  return result;
}

}  // namespace

SheetModes sheet_modes(const Sheet& sheet, Index count) {
  assert(count >= 1 && count < sheet.particles());
  const Index n = sheet.particles();
  const auto particles = static_cast<double>(n);
  // An iteration takes from mode `count` what is not its own by λ_count/λ_width, near ½.
  const Index width = std::min(2 * count + 8, n - 1);
  constexpr int most_iterations = 100;
  const double tolerance = 1e-12 + 1e-15 * particles;  // K·φ is rounded in units of λ_N ~ N·λ₁

  const SparseMatrix stiffness = laplacian(sheet);
  const auto mass = sheet.relative_mass.asDiagonal();
  // The constant mode is kept away by a shift well below λ₁, which is about 10/N.
  const double shift = 1 / particles;
  SparseMatrix shifted = stiffness;
  for (Index i = 0; i < n; ++i) shifted.coeffRef(i, i) += shift * sheet.relative_mass[i];
  const Eigen::SimplicialLDLT<SparseMatrix> factor(shifted);

  MatrixXd x = patterns(n, width);
  Vector eigenvalues = Vector::Zero(width);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    x = factor.solve(mass * x) * (eigenvalues.array() + shift).matrix().asDiagonal();
    x.rowwise() -= sheet.relative_mass.transpose() * x / particles;
    const MatrixXd applied = stiffness * x;
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> ritz(x.transpose() * applied,
                                                                  x.transpose() * (mass * x));
    eigenvalues = ritz.eigenvalues();
    x *= ritz.eigenvectors();
    const MatrixXd residual = applied * ritz.eigenvectors().leftCols(count) -
                              mass * x.leftCols(count) * eigenvalues.head(count).asDiagonal();
    const Vector sizes =
        (sheet.relative_mass.cwiseInverse().cwiseSqrt().asDiagonal() * residual).colwise().norm();
    if (sizes.cwiseQuotient(eigenvalues.head(count)).maxCoeff() < tolerance) break;
  }
  return {x.leftCols(count).transpose(), eigenvalues.head(count)};
}

}  // namespace nuno
