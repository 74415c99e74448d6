#pragma once

#include <nuno/points.h>

namespace nuno {

/// How far a shape is from its target, particle by particle [m].
struct ArrivalError {
  double mean = 0;      ///< the paper's error: mean distance (§ 3.2.3)
  double max = 0;       ///< the worst particle
  double centroid = 0;  ///< distance of the centroids
};

ArrivalError arrival_error(const Points& final, const Points& target);

/// Mean and largest distance of two shapes [2 × N] with their centroids aligned [m].
struct ShapeDifference {
  double mean = 0;
  double max = 0;
};

ShapeDifference shape_difference(const Points& a, const Points& b);

}  // namespace nuno
