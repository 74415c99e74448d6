#pragma once

#include <nuno/cloth.h>

namespace nuno {

/// How far a shape is from its target, particle by particle [m].
struct ArrivalError {
  double mean = 0;      ///< the paper's error: mean distance (§ 3.2.3)
  double max = 0;       ///< the worst particle
  double centroid = 0;  ///< distance of the centroids
};

/// Shapes [d × N] of particles of equal mass.
ArrivalError arrival_error(const Points& final, const Points& target);
/// The same of a cloth whose masses may differ: `centroid` is of the mass centres.
ArrivalError arrival_error(const Cloth& cloth, const Points& final, const Points& target);

/// The derivative of the mean by the final positions [d × N]: residual/|residual|/N, 0 where a
/// particle has arrived.
Points error_cotangent(const Points& final, const Points& target);

/// Mean and largest distance of two shapes [d × N] with their centroids aligned [m].
struct ShapeDifference {
  double mean = 0;
  double max = 0;
};

ShapeDifference shape_difference(const Points& a, const Points& b);
/// The same with the mass centres aligned.
ShapeDifference shape_difference(const Cloth& cloth, const Points& a, const Points& b);

}  // namespace nuno
