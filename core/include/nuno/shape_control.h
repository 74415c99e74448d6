#pragma once

#include <nuno/gains.h>
#include <nuno/reference_motion.h>

namespace nuno {

/// Equation (3): f = α·(target − current − (x_c, y_c)) on every particle, where (x_c, y_c) is the
/// difference of the two centroids, so that the force corrects shape only and sums to zero.
/// `target_shape` is the target about its own centroid (see shape_of and reference_motion.h); all
/// are [d × N]. Here masses are equal; ShapeControl knows those that differ.
void shape_control(const Points& target_shape, const Points& positions, double gain,
                   Points& forces);

/// Adds β·(velocity of the reference − velocity), centroids aligned: the damping of the control
/// force, which sums to zero too. All are [d × N].
void add_shape_damping(const Points& reference_velocity, const Points& velocities, double damping,
                       Points& forces);

/// β = 2ζ·√(α·m) [kg/s]: damping ratio ζ of the oscillation that gain α gives a particle of mass m.
double shape_damping(double damping_ratio, double gain, double particle_mass);

/// The control force of a problem under gains that differ by group. With o what is missing of the
/// shape, the reference about its mass centre less the cloth about its own, and ȯ the same of the
/// velocities,
///     p = α·o + β·ȯ + Σⱼ ((αⱼ − α)·⟨φⱼ, o⟩ₘ + (βⱼ − β)·⟨φⱼ, ȯ⟩ₘ)·φⱼ
/// over the low modes φⱼ, with ⟨a, b⟩ₘ = Σᵢ (mᵢ/m̄)·aᵢ·bᵢ; α is the last group's gain and each gain
/// has its own shape_damping β. A particle of mass mᵢ gets the force (mᵢ/m̄)·pᵢ, so that all sum to
/// zero and the mass centre flies alone. A mode of a group feels that group's gain alone, and one
/// group is equation (3).
class ShapeControl {
 public:
  ShapeControl(const Problem& problem, const Gains& gains)
      : ShapeControl(problem, gains, LowModes(problem, gains.count())) {}
  /// The same with the problem's low modes for so many groups.
  ShapeControl(const Problem& problem, const Gains& gains, LowModes modes);

  /// Whether any gain is above zero.
  bool pulls() const { return pulls_; }

  /// What a particle of mean mass would feel, p; all are [d × N].
  void pull(const ReferenceMotion& reference, const Points& positions, const Points& velocities,
            Points& pulls) const;

  /// The forces on the particles, (mᵢ/m̄)·pᵢ.
  void to_forces(const Points& pulls, Points& forces) const;

 private:
  Vector relative_mass_;
  bool pulls_;
  double gain_;     ///< of the last group
  double damping_;  ///< of the last group
  LowModes modes_;
  Vector excess_gain_;     ///< αⱼ − α [modes]
  Vector excess_damping_;  ///< βⱼ − β [modes]
};

}  // namespace nuno
