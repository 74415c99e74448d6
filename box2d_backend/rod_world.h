#pragma once

#include "rod_chain.h"

#include <memory>
#include <vector>

class b2Body;
class b2Joint;
class b2World;

namespace nuno::box2d {

/// The rods as Box2D's bodies and joints, for steps that are half a kick.
class RodWorld {
 public:
  RodWorld(const RodChain& chain, double half_kick);
  ~RodWorld();

  /// Adds to what acts on a rod in the next step.
  void push(Index rod, const Eigen::Vector2d& force, double torque);

  /// What Box2D makes of a step, rounded to single precision.
  struct Step {
    Motions velocities;         ///< that the joints allow
    Motions corrections;        ///< of the position solver
    Eigen::Matrix2Xd impulses;  ///< λ of every hinge
  };
  Step step(const Motions& poses, const Motions& velocities, int velocity_iterations,
            int position_iterations);

 private:
  b2Joint* join(const RodChain& chain, double half_kick, std::size_t hinge);

  std::unique_ptr<b2World> world_;
  std::vector<b2Body*> bodies_;   // of the rods
  std::vector<b2Joint*> joints_;  // that hold the hinges together: revolute or weld
};

}  // namespace nuno::box2d
