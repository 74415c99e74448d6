#pragma once

#include <nuno/points.h>

namespace nuno {

/// Equation (3): f = α·(target − current − (x_c, y_c)) on every particle, where (x_c, y_c) is the
/// difference of the two centroids, so that the force corrects shape only and sums to zero.
/// `target_shape` is the target about its own centroid (see shape_of and reference_motion.h); all
/// are [2 × N].
void shape_control(const Points& target_shape, const Points& positions, double gain,
                   Points& forces);

/// Adds β·(velocity of the reference − velocity), centroids aligned: the damping of the control
/// force, which sums to zero too. All are [2 × N].
void add_shape_damping(const Points& reference_velocity, const Points& velocities, double damping,
                       Points& forces);

/// β = 2ζ·√(α·m) [kg/s]: damping ratio ζ of the oscillation that gain α gives a particle of mass m.
double shape_damping(double damping_ratio, double gain, double particle_mass);

}  // namespace nuno
