#pragma once

#include <nuno/sheet.h>

#include <Eigen/SparseCore>
#include <vector>

namespace nuno {

/// What springs or hinges of a sheet do about some positions: a small displacement u of the
/// particles changes each length or angle by g·u, and calls forth the forces −K·u with
/// K = Σ k·g·gᵀ over all (and −C·u̇, C = Σ c·g·gᵀ, of the dashpots).
struct LinearElements {
  Index nodes = 0;                        ///< particles that each g touches: 2 or 4
  std::vector<Index> at;                  ///< them [nodes × count]
  std::vector<Eigen::Vector3d> gradient;  ///< g [nodes × count], 1 of lengths, 1/m of angles
  std::vector<double> stiffness;          ///< k [count], N/m or N·m
  std::vector<double> damping;            ///< c [count], N·s/m or N·m·s

  std::size_t count() const { return stiffness.size(); }
};

/// The springs of stretch and shear at these positions [3 × N], m.
LinearElements linear_springs(const Sheet& sheet, const Points& positions);

/// The hinges at these positions [3 × N], m.
LinearElements linear_hinges(const Sheet& sheet, const Points& positions);

/// K of all springs and hinges at these positions [3N × 3N, a particle after another], N/m: the
/// material's own stiffness, without what tensions add. Symmetric, positive semidefinite.
Eigen::SparseMatrix<double> stiffness_matrix(const Sheet& sheet, const Points& positions);

}  // namespace nuno
