#include <nuno/shape_control.h>

#include <cassert>
#include <cmath>

namespace nuno {

void shape_control(const Points& target_shape, const Points& positions, double gain,
                   Points& forces) {
  assert(target_shape.cols() == positions.cols() && target_shape.rows() == positions.rows());
  const Vector center = centroid(positions);
  forces = gain * (target_shape - (positions.colwise() - center));
}

void add_shape_damping(const Points& reference_velocity, const Points& velocities, double damping,
                       Points& forces) {
  const Vector drift = centroid(velocities);
  forces += damping * (reference_velocity - (velocities.colwise() - drift));
}

double shape_damping(double damping_ratio, double gain, double particle_mass) {
  return 2 * damping_ratio * std::sqrt(gain * particle_mass);
}

}  // namespace nuno
