#include <nuno/sheet_stiffness.h>

#include <Eigen/Geometry>

namespace nuno {

using Eigen::Vector3d;

LinearElements linear_springs(const Sheet& sheet, const Points& positions) {
  LinearElements linear{2, {}, {}, {}, {}};
  for (const Springs* springs : {&sheet.stretch, &sheet.shear}) {
    for (Index e = 0; e < springs->count(); ++e) {
      const Index a = springs->ends(0, e), b = springs->ends(1, e);
      const Vector3d t = (positions.col(b) - positions.col(a)).normalized();
      linear.at.insert(linear.at.end(), {a, b});
      linear.gradient.insert(linear.gradient.end(), {-t, t});
      linear.stiffness.push_back(springs->stiffness[e]);
      linear.damping.push_back(springs->damping[e]);
    }
  }
  return linear;
}

LinearElements linear_hinges(const Sheet& sheet, const Points& positions) {
  LinearElements linear{4, {}, {}, {}, {}};
  for (Index h = 0; h < sheet.hinges.count(); ++h) {
    const auto corners = sheet.hinges.corners.col(h);
    const Vector3d a = positions.col(corners[0]), b = positions.col(corners[1]);
    const Vector3d c = positions.col(corners[2]), d = positions.col(corners[3]);
    const Vector3d e = b - a;
    const Vector3d n1 = e.cross(c - a), n2 = (d - a).cross(e);
    const Vector3d at_c = -e.norm() / n1.squaredNorm() * n1;
    const Vector3d at_d = -e.norm() / n2.squaredNorm() * n2;
    const double t1 = (c - a).dot(e) / e.squaredNorm(), t2 = (d - a).dot(e) / e.squaredNorm();
    const Vector3d at_b = -(t1 * at_c + t2 * at_d);
    linear.at.insert(linear.at.end(), corners.begin(), corners.end());
    linear.gradient.insert(linear.gradient.end(), {-(at_b + at_c + at_d), at_b, at_c, at_d});
    linear.stiffness.push_back(sheet.hinges.stiffness[h]);
    linear.damping.push_back(sheet.hinges.damping[h]);
  }
  return linear;
}

namespace {

void add_blocks(const LinearElements& linear, std::vector<Eigen::Triplet<double>>& entries) {
  const auto nodes = static_cast<std::size_t>(linear.nodes);
  for (std::size_t e = 0; e < linear.count(); ++e) {
    for (std::size_t p = nodes * e; p < nodes * (e + 1); ++p) {
      for (std::size_t q = nodes * e; q < nodes * (e + 1); ++q) {
        for (Index row = 0; row < 3; ++row) {
          for (Index col = 0; col < 3; ++col) {
            entries.emplace_back(
                3 * linear.at[p] + row, 3 * linear.at[q] + col,
                linear.stiffness[e] * linear.gradient[p][row] * linear.gradient[q][col]);
          }
        }
      }
    }
  }
}

}  // namespace

Eigen::SparseMatrix<double> stiffness_matrix(const Sheet& sheet, const Points& positions) {
  std::vector<Eigen::Triplet<double>> entries;
  add_blocks(linear_springs(sheet, positions), entries);
  add_blocks(linear_hinges(sheet, positions), entries);
  Eigen::SparseMatrix<double> matrix(3 * sheet.particles(), 3 * sheet.particles());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace nuno
