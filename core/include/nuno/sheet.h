#pragma once

#include <nuno/cloth.h>

namespace nuno {

/// Springs with dashpots between pairs of particles: k·(l − ℓ) + c·l̇ along each.
struct Springs {
  Edges ends;          ///< [2 × springs]
  Vector rest_length;  ///< ℓ [m]
  Vector stiffness;    ///< k [N/m]
  Vector damping;      ///< c [N·s/m]

  Index count() const { return ends.cols(); }
};

/// Hinges at edges between two triangles: ½·k·(θ − θ₀)², θ the signed dihedral angle, 0 where both
/// lie flat, and the dashpot moment c·θ̇.
struct Hinges {
  /// Particles of each [4 × hinges]: the edge's two ends, then the corner of either triangle that
  /// is not on the edge. Seen from the side that both normals point to, the first triangle runs
  /// (0, 1, 2) and the second (1, 0, 3).
  Eigen::Matrix<Index, 4, Eigen::Dynamic> corners;
  Vector rest_angle;  ///< θ₀ [rad]
  Vector stiffness;   ///< k [N·m]
  Vector damping;     ///< c [N·m·s]

  Index count() const { return corners.cols(); }
};

/// The mechanical sheet in space that every engine realises. L = √(rest area). Its edges are those
/// of its faces.
struct Sheet : Cloth {
  Faces faces;
  /// Of the faces, a quad by both diagonals [3 × T], and how much each counts: 1, and ½ of a quad.
  Eigen::Matrix<Index, 3, Eigen::Dynamic> triangles;
  Vector triangle_weight;
  Springs stretch;  ///< along the edges, in their order
  Springs shear;    ///< along both diagonals of every quad
  Hinges hinges;
  SheetMaterial material;
};

/// A sheet at rest in the initial shape, with the laws of its material:
///  - mass: a vertex carries a third (quad: a quarter) of each of its faces' area × density; drag
///    in proportion;
///  - stretch: k = S·a/ℓ² along every edge, a the whole area of each triangle and half the area of
///    each quad beside it; c = damping·a/ℓ²;
///  - shear: springs along both diagonals of every quad, half the shear stiffness each on a square;
///  - bending: at every inner edge e between two triangles k = 3·B·|e|²/(A₀ + A₁). A quad stands
///    for both of its triangulations, so that no diagonal is preferred. A mesh so made bends about
///    one axis with the moment 3·B (squares) to 27/8·B (equilateral triangles) per curvature and
///    width.
/// The faces must be a valid mesh, see validate.
Sheet make_sheet(const Points& initial, const Faces& faces, const SheetMaterial& material,
                 Rest rest, double gravity);

/// Area of the faces [m²]; a quad that is not flat counts as the mean of its triangulations.
double area(const Points& x, const Faces& faces);

/// θ of a hinge with these corners, see Hinges, in (−π, π] [rad]; x is [3 × N].
double dihedral_angle(const Points& x, const Eigen::Matrix<Index, 4, 1>& corners);

}  // namespace nuno
