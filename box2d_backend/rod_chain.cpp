#include "rod_chain.h"

#include <cmath>

namespace nuno::box2d {
namespace {

// A rod is two point masses a rod's length ℓ apart, its particles' shares m₁ and m₂: half of an
// inner particle, all of a free end. So, measured from the centre of mass,
//     mass = m₁ + m₂,   left = −ℓ·m₂/mass,   right = ℓ·m₁/mass,   inertia = m₁·m₂·ℓ²/mass,
// and the joined rods are the point masses on segments that do not stretch, since a particle's two
// halves move together. The same shares split the force on a particle.
Rod make_rod(double length, bool first, bool last) {
  Rod rod;
  rod.length = length;
  rod.left_share = first ? 1 : 0.5;
  rod.right_share = last ? 1 : 0.5;
  rod.mass = rod.left_share + rod.right_share;
  rod.left = -length * rod.right_share / rod.mass;
  rod.right = length * rod.left_share / rod.mass;
  rod.inertia = rod.left_share * rod.right_share * length * length / rod.mass;
  return rod;
}

// Soft weld: a b2WeldJoint of that stiffness and damping.
//
// Spring pair: on either side of the rods, a soft b2DistanceJoint from (−a, ±d) on one to (a, ±d)
// on the next, seen from the hinge along each. With φ = θ/2 they are 2·(a·cos φ ∓ d·sin φ) long and
// 2a at rest; springs k store 4k·[a²·(1 − cos φ)² + d²·sin² φ], whose derivative by θ is the moment
//     4k·d²·sin φ·[(a/d)²·(1 − cos φ) + cos φ] = (EI/ℓ̄)·θ·(1 + O(θ⁴))
// for k = EI/(2·ℓ̄·d²) and (a/d)² = 4/3. At tan φ = a/d (θ = 98°) it is 1.6 % too small and the
// inner spring has no length left. Dashpots ηI/(2·ℓ̄·d²) give (ηI/ℓ̄)·θ̇·(1 + sin²φ/3).
HingeSpring make_hinge_spring(const ChainMaterial& cloth, double length, const RodChain& chain) {
  const double unit_moment = chain.unit_force * chain.unit_length;
  HingeSpring spring;
  spring.stiffness = cloth.hinge_stiffness / length / unit_moment;
  spring.damping = cloth.hinge_damping / length / (unit_moment * chain.h);
  if (chain.hinge == Hinge::spring_pair) {
    spring.along = length / chain.unit_length / 2;
    spring.aside = spring.along * std::sqrt(0.75);
    spring.stiffness /= 2 * spring.aside * spring.aside;
    spring.damping /= 2 * spring.aside * spring.aside;
  }
  return spring;
}

}  // namespace

// A moment k·θ on the particles of a straight chain has the highest frequency ω² = 16·k/(m·ℓ²).
HingeRates hinge_rates(const Chain& chain) {
  const double shortest = chain.rest_length.minCoeff();
  const double per_hinge =
      16 / (chain.hinge_length.minCoeff() * shortest * shortest * chain.particle_mass);
  return {per_hinge * chain.material.hinge_stiffness, per_hinge * chain.material.hinge_damping};
}

RodChain make_rod_chain(const Problem& problem, Hinge hinge, Index steps) {
  const Chain& chain = problem.chain();
  const Index rods = chain.particles() - 1;
  RodChain result;
  result.h = problem.arrival_time / static_cast<double>(steps);
  result.unit_length = chain.size / static_cast<double>(rods);
  result.unit_force = chain.particle_mass * result.unit_length / (result.h * result.h);
  result.hinge = hinge;
  for (Index i = 0; i < rods; ++i) {
    const double length = chain.rest_length[i] / result.unit_length;
    result.rods.push_back(make_rod(length, i == 0, i + 1 == rods));
  }
  for (const double length : chain.hinge_length) {
    result.hinges.push_back(make_hinge_spring(chain.material, length, result));
  }
  const HingeRates rates = hinge_rates(chain);
  result.hinge_rigidity = rates.rigidity(result.h);
  const double dashpots = result.h * rates.damping;
  const double springs = result.h * result.h * rates.squared_frequency;
  result.solves_joints =
      hinge == Hinge::soft_weld && dashpots > most_iterated && dashpots > springs;
  result.drag_rate = chain.drag_rate * result.h;
  return result;
}

double turning_angle(const Eigen::Vector2d& before, const Eigen::Vector2d& after) {
  return std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
}

}  // namespace nuno::box2d
