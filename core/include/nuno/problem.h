#pragma once

#include <nuno/scene.h>

#include <vector>

namespace nuno {

/// The mechanical chain that every engine realises: N equal particles on N − 1 segments, a hinge
/// at each of the N − 2 inner particles, straight at rest.
struct Chain {
  Points initial;            ///< positions at t = 0 [2 × N], m
  Vector rest_length;        ///< ℓ [N − 1], m: the segments' lengths in `initial`
  Vector hinge_length;       ///< ℓ̄ [N − 2], m: mean of a hinge's two rest lengths
  double length = 0;         ///< L = Σℓ [m]
  double particle_mass = 0;  ///< m = M/N [kg]
  double particle_drag = 0;  ///< k = K/N [kg/s]
  double gravity = 0;        ///< g, downward [m/s²]
  Cloth cloth;

  Index particles() const { return initial.cols(); }
  /// κ = k/m, the rate at which drag takes velocity [1/s].
  double drag_rate() const { return particle_drag / particle_mass; }
};

/// A validated scene, resampled: throw this chain so that it has this shape, there, then.
struct Problem {
  Chain chain;
  Points target;            ///< [2 × N], m, at the length that the scene asks for
  double target_scale = 1;  ///< what `fit` did to the drawn target
  double arrival_time = 0;  ///< t₀ [s]
  Launch launch = Launch::ballistic;
  Reference reference = Reference::hold;
  Arrival arrival = Arrival::pass;
  double damping_ratio = 0;  ///< ζ of the control force
  /// How far beside its way the reference motion aims, a shape [2 × N], m, for each of aim_powers
  /// (reference_motion.h); empty: not at all.
  std::vector<Points> aim_offset;
};

/// Throws InputError for a scene that is not valid, or has a segment of no length; `source` names
/// the scene's file in the message, its name does without.
Problem make_problem(const Scene& scene, std::string source = {});

}  // namespace nuno
