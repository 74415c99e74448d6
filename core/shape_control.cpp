#include <nuno/shape_control.h>

#include <cassert>

namespace nuno {

void shape_control(const Points& target_shape, const Points& positions, double gain,
                   Points& forces) {
  assert(target_shape.cols() == positions.cols() && target_shape.rows() == positions.rows());
  const Vector center = centroid(positions);
  forces = gain * (target_shape - (positions.colwise() - center));
}

}  // namespace nuno
