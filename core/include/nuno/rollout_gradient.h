#pragma once

#include <nuno/points.h>

#include <functional>
#include <vector>

namespace nuno {

/// What a quantity J of a flight gains by a change of how the flight ends: the seed of an adjoint.
struct RolloutCotangent {
  Points arrival;             ///< ∂J/∂(final positions) [d × N], J's unit per m
  double squared_effort = 0;  ///< ∂J/∂(control effort²), see Rollout
};

/// The cotangent of J at a flight that ends in these positions [d × N], m. That of E is
/// error_cotangent.
using CotangentAt = std::function<RolloutCotangent(const Points& final)>;

/// The gradient of a quantity J of a flight, by the adjoint of the engine's own steps (reverse
/// mode; Griewank and Walther 2008): exact, to rounding, for the flight that the engine computes.
struct RolloutGradient {
  Points final;               ///< positions at arrival [d × N], m
  double squared_effort = 0;  ///< of the flight: control effort², see Rollout

  /// dJ/dα [J's unit per N/m]; damped and at α = 0, where it is infinite, of the springs; 0 where
  /// the rollout diverged.
  double gain = 0;
  /// By the launch velocities, at the same reference [d × N], per m/s; empty where it diverged.
  Points launch;
  /// By the reference correction of each of correction_powers, through the reference and through
  /// the launch that follows it [d × N each], per m; empty where it diverged. Each sums to zero:
  /// the mass centre flies alone.
  std::vector<Points> reference_correction;
};

}  // namespace nuno
