#pragma once

#include <nuno/box2d.h>

#include <vector>

namespace nuno::box2d {

// Inside, the unit of length is the mean rod, of mass a particle, of time a step: every number that
// Box2D sees is near 1 whatever the scene's scale, and its step of 1 stays out of the formulae.

/// A pose or velocity for every rod [3 × rods]: its centre of mass and its angle.
using Motions = Eigen::Matrix3Xd;

/// A segment as a rigid body, along its own x axis from its centre of mass; see rod_chain.cpp.
struct Rod {
  double length = 1;
  double left_share = 0.5;  ///< m₁, of the mass of the particle at its left end
  double right_share = 0.5;
  double mass = 1;
  double left = -0.5;  ///< abscissa of the particles along the rod
  double right = 0.5;
  double inertia = 0.25;
};

/// The springs at one hinge, of moment EI·θ/ℓ̄ + ηI·θ̇/ℓ̄; see rod_chain.cpp.
struct HingeSpring {
  double stiffness = 0;  ///< of the weld or of each spring of the pair
  double damping = 0;
  double along = 0;  ///< a, of the pair
  double aside = 0;  ///< d
};

constexpr double pair_range = 1.7;  // rad; the inner spring is 0.009 rods long there

/// Iterations solve for soft welds up to this damping in a step, hc, and where springs are stiffer:
/// h²ω² > hc. Beyond, joint_impulses.h takes less time, seven times less at 300.
constexpr double most_iterated = 30;

/// The fastest that the hinges of a chain move it.
struct HingeRates {
  double squared_frequency = 0;  ///< ω² [1/s²]
  double damping = 0;            ///< c [1/s]

  double rigidity(double h) const { return h * (h * squared_frequency + damping); }
};
HingeRates hinge_rates(const Chain& chain);

/// The cloth as rods with springs at their hinges, the same for every flight.
struct RodChain {
  double h = 0;            ///< the unit of time [s]
  double unit_length = 0;  ///< [m]
  double unit_force = 0;   ///< [N]
  Hinge hinge = Hinge::soft_weld;
  std::vector<Rod> rods;
  std::vector<HingeSpring> hinges;
  double hinge_rigidity = 0;   ///< h²ω² + hc, see hinge_rates
  bool solves_joints = false;  ///< see joint_impulses.h: Box2D has the joints alone
  double drag_rate = 0;        ///< κ
};

RodChain make_rod_chain(const Problem& problem, Hinge hinge, Index steps);

/// θ from one segment to the next, in (−π, π].
double turning_angle(const Eigen::Vector2d& before, const Eigen::Vector2d& after);

}  // namespace nuno::box2d
