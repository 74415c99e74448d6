#pragma once

#include "rod_chain.h"

#include <vector>

namespace nuno::box2d {

/// What joints and hinges give in a step, solved for all at once: for hinges that are too rigid for
/// iterations. An impulse is a force and a moment, on the later rod of its joint; the earlier one
/// gets the opposite.
class JointImpulses {
 public:
  /// Of a chain that outlives it, whose springs and dashpots act for this part of a step.
  JointImpulses(const RodChain& chain, double part);

  /// Impulses [3 × hinges] in the step from these angles of the hinges [hinges], on rods that would
  /// move so by themselves [3 × rods]. `turning` is the hinges' rate that springs are taken back by
  /// (see chain_simulation.cpp) [hinges]; `left` and `right` are the rods' ends from their centres
  /// [2 × rods].
  const Motions& solve(const Vector& angles, const Vector& turning, const Motions& free,
                       const Eigen::Matrix2Xd& left, const Eigen::Matrix2Xd& right);

 private:
  struct Joint {
    Eigen::Matrix3d inverse;   ///< of its own block, once those before are eliminated
    Eigen::Matrix3d coupling;  ///< to the next joint
    Eigen::Vector3d impulse;
  };

  const RodChain& chain_;
  Vector spring_, dashpot_;  ///< k and c over the part of a step [hinges]
  std::vector<Joint> joints_;
  Motions impulses_;
};

}  // namespace nuno::box2d
