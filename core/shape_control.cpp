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

ShapeControl::ShapeControl(const Problem& problem, const Gains& gains)
    : pulls_(gains.largest() > 0),
      gain_(gains.rest),
      damping_(shape_damping(problem.damping_ratio, gains.rest, problem.chain.particle_mass)),
      modes_(problem.chain.particles(), gains.count()),
      excess_gain_(modes_.count()),
      excess_damping_(modes_.count()) {
  for (Index j = 0; j < modes_.count(); ++j) {
    const double gain =
        gains.low[static_cast<std::size_t>(modes_.group[static_cast<std::size_t>(j)])];
    excess_gain_[j] = gain - gain_;
    excess_damping_[j] =
        shape_damping(problem.damping_ratio, gain, problem.chain.particle_mass) - damping_;
  }
}

void ShapeControl::pull(const ReferenceMotion& reference, const Points& positions,
                        const Points& velocities, Points& forces) const {
  shape_control(reference.shape(), positions, gain_, forces);
  if (damping_ > 0) add_shape_damping(reference.velocity(), velocities, damping_, forces);
  if (modes_.count() == 0) return;
  // Summed in the native kernel's order, so that both agree to the last bit.
  const Points offset = reference.shape() - shape_of(positions);
  const Points lag = reference.velocity() - shape_of(velocities);
  Points spring = Points::Zero(positions.rows(), modes_.count());
  Points dashpot = spring;
  for (Index i = 0; i < positions.cols(); ++i) {
    spring += offset.col(i) * modes_.shapes.col(i).transpose();
    dashpot += lag.col(i) * modes_.shapes.col(i).transpose();
  }
  for (Index j = 0; j < modes_.count(); ++j) {
    const Vector amplitude = excess_gain_[j] * spring.col(j) + excess_damping_[j] * dashpot.col(j);
    forces += amplitude * modes_.shapes.row(j);
  }
}

}  // namespace nuno
