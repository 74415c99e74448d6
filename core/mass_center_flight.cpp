#include <nuno/mass_center_flight.h>

namespace nuno {

MassCenterFlight::MassCenterFlight(const Backend& backend, const Points& positions,
                                   const Points& velocities)
    : recurrence_(backend.drag_recurrence()),
      gravity_(backend.cloth().gravity),
      particle_mass_(backend.cloth().particle_mass),
      position_(backend.cloth().mass_center(positions)),
      velocity_(backend.cloth().mass_center(velocities)) {}

void MassCenterFlight::step(const Vector& mean_force) {
  const double r = first_ ? recurrence_.r1 : recurrence_.r;
  const double q = first_ ? recurrence_.q1 : recurrence_.q;
  velocity_ = r * velocity_ + q / particle_mass_ * mean_force;
  velocity_[1] -= q * gravity_;
  position_ += recurrence_.h * velocity_;
  first_ = false;
}

}  // namespace nuno
