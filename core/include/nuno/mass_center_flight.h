#pragma once

#include <nuno/backend.h>

namespace nuno {

/// The flight of a cloth's mass centre. Gravity is uniform, drag goes with the mass that a particle
/// carries, and internal forces sum to zero: so the mass centre flies as one particle of mean mass
/// under the mean of the external forces, whatever the shape does. An engine of single precision
/// may leave that flight to this one, in double precision, and fly the cloth about its mass centre,
/// where there is no gravity and all coordinates are of the cloth's size however far it is thrown.
class MassCenterFlight {
 public:
  /// By the backend's own drag recurrence from the mass centre of these positions and velocities
  /// [d × N], m and m/s.
  MassCenterFlight(const Backend& backend, const Points& positions, const Points& velocities);

  /// Goes on by one time step under external forces of this mean over the particles [d], N.
  void step(const Vector& mean_force);

  const Vector& position() const { return position_; }  ///< [d], m
  const Vector& velocity() const { return velocity_; }  ///< mean over the last step [d], m/s

 private:
  DragRecurrence recurrence_;
  double gravity_;
  double particle_mass_;
  Vector position_;
  Vector velocity_;
  bool first_ = true;
};

}  // namespace nuno
