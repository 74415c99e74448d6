#pragma once

#include <nuno/scene.h>

namespace nuno {

/// Pairs of particles [2 × edges], a column each.
using Edges = Eigen::Matrix<Index, 2, Eigen::Dynamic>;

/// What launch, control, rollout, error and search need to know of a cloth, in the plane (d = 2) or
/// in space (d = 3), whatever holds its particles together.
struct Cloth {
  Points initial;            ///< positions at t = 0 [d × N], m
  Vector relative_mass;      ///< mᵢ/m̄ [N]; sums to N, and is exactly 1 all over a chain
  double particle_mass = 0;  ///< m̄, the mean over the particles [kg]
  double drag_rate = 0;  ///< κ = kᵢ/mᵢ of every particle, the rate drag takes velocity at [1/s]
  double gravity = 0;    ///< g, downward along y [m/s²]
  Edges edges;           ///< what resists stretching [2 × E]
  Vector rest_length;    ///< ℓ of the edges [E], m: their lengths in `initial`
  double size = 0;       ///< L, what errors are relative to [m]: a chain's length, √(area)
  double sound_speed = 0;  ///< of stretching waves [m/s]

  Index particles() const { return initial.cols(); }
  Index dimension() const { return initial.rows(); }
  Points shape_of(const Points& points) const { return nuno::shape_of(points, relative_mass); }
  Vector mass_center(const Points& points) const {
    return nuno::mass_center(points, relative_mass);
  }
};

/// The mechanical chain in the plane: N equal particles on N − 1 segments (the edges, in order), a
/// hinge at each of the N − 2 inner particles, straight at rest. L = Σℓ.
struct Chain : Cloth {
  Vector hinge_length;  ///< ℓ̄ [N − 2], m: mean of a hinge's two rest lengths
  ChainMaterial material;
};

/// A chain at rest in these positions [2 × N].
Chain make_chain(const Points& initial, const ChainMaterial& material, double gravity);

}  // namespace nuno
