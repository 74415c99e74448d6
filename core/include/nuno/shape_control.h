#pragma once

#include <nuno/points.h>

namespace nuno {

/// Equation (3): f = α·(target − current − (x_c, y_c)) on every particle, where (x_c, y_c) is the
/// difference of the two centroids, so that the force corrects shape only and sums to zero.
/// `target_shape` is the target about its own centroid, see shape_of; all are [2 × N].
void shape_control(const Points& target_shape, const Points& positions, double gain,
                   Points& forces);

}  // namespace nuno
