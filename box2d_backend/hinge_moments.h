#pragma once

#include "rod_chain.h"

#include <vector>

namespace nuno::box2d {

/// The moments of hinges that are too rigid for iterations, all at once.
class HingeMoments {
 public:
  /// Of a chain that outlives it, whose springs act for this part of a step.
  HingeMoments(const RodChain& chain, double half_kick);

  /// What the hinges give in the step from these angles [hinges], where without them and the joints
  /// the rods would move so: impulses on the later rod of each [hinges]. `left` and `right` are the
  /// rods' ends from their centres [2 × rods]; `turning` is the hinges' rate that springs are taken
  /// back by, see chain_simulation.cpp [hinges].
  const Vector& solve(const Vector& angles, const Vector& turning, const Motions& free,
                      const Eigen::Matrix2Xd& left, const Eigen::Matrix2Xd& right);

 private:
  struct Joint {
    Eigen::Matrix3d factor;    ///< of its equation, once those before are eliminated
    Eigen::Matrix3d coupling;  ///< to the next joint
    Eigen::Vector3d impulse;   ///< force and moment
  };

  const RodChain& chain_;
  Vector spring_, dashpot_;  ///< q·k and q·c [hinges]
  std::vector<Joint> joints_;
  Vector moments_;
};

}  // namespace nuno::box2d
