#include <nuno/shape_control.h>

#include <cassert>
#include <cmath>
#include <utility>

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

ShapeControl::ShapeControl(const Problem& problem, const Gains& gains, LowModes modes)
    : relative_mass_(problem.cloth().relative_mass),
      pulls_(gains.largest() > 0),
      gain_(gains.rest),
      damping_(shape_damping(problem.damping_ratio, gains.rest, problem.cloth().particle_mass)),
      modes_(std::move(modes)),
      excess_gain_(modes_.count()),
      excess_damping_(modes_.count()) {
  for (Index j = 0; j < modes_.count(); ++j) {
    const double gain =
        gains.low[static_cast<std::size_t>(modes_.group[static_cast<std::size_t>(j)])];
    excess_gain_[j] = gain - gain_;
    excess_damping_[j] =
        shape_damping(problem.damping_ratio, gain, problem.cloth().particle_mass) - damping_;
  }
}

void ShapeControl::pull(const ReferenceMotion& reference, const Points& positions,
                        const Points& velocities, Points& pulls) const {
  const Vector center = mass_center(positions, relative_mass_);
  pulls = gain_ * (reference.shape() - (positions.colwise() - center));
  if (damping_ > 0) {
    const Vector drift = mass_center(velocities, relative_mass_);
    pulls += damping_ * (reference.velocity() - (velocities.colwise() - drift));
  }
  if (modes_.count() == 0) return;
  // Summed in the native kernel's order, so that both agree to the last bit.
  const auto mass = relative_mass_.asDiagonal();
  const Points offset = (reference.shape() - shape_of(positions, relative_mass_)) * mass;
  const Points lag = (reference.velocity() - shape_of(velocities, relative_mass_)) * mass;
  Points spring = Points::Zero(positions.rows(), modes_.count());
  Points dashpot = spring;
  for (Index i = 0; i < positions.cols(); ++i) {
    spring += offset.col(i) * modes_.shapes.col(i).transpose();
    dashpot += lag.col(i) * modes_.shapes.col(i).transpose();
  }
  for (Index j = 0; j < modes_.count(); ++j) {
    const Vector amplitude = excess_gain_[j] * spring.col(j) + excess_damping_[j] * dashpot.col(j);
    pulls += amplitude * modes_.shapes.row(j);
  }
}

void ShapeControl::to_forces(const Points& pulls, Points& forces) const {
  forces = pulls.array().rowwise() * relative_mass_.transpose().array();
}

}  // namespace nuno
