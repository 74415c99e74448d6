#include "joint_impulses.h"

#include <Eigen/LU>

namespace nuno::box2d {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// G(r), from a rod's motion to that of its point at r from the centre.
Matrix3d motion_at(const Vector2d& r) {
  Matrix3d result;
  result << 1, 0, -r.y(), 0, 1, r.x(), 0, 0, 1;
  return result;
}

}  // namespace

JointImpulses::JointImpulses(const RodChain& chain, double part)
    : chain_(chain),
      spring_(static_cast<Index>(chain.hinges.size())),
      dashpot_(spring_.size()),
      joints_(chain.hinges.size()),
      impulses_(3, spring_.size()) {
  for (Index i = 0; i < spring_.size(); ++i) {
    const HingeSpring& hinge = chain.hinges[static_cast<std::size_t>(i)];
    spring_[i] = part * hinge.stiffness;
    dashpot_[i] = part * hinge.damping;
  }
}

// The impulses p at its two ends leave a rod with V + W·(G(left)ᵀ·p − G(right)ᵀ·p), W its inverse
// mass and inertia. At every joint then
//     the ends of neighbours move alike, and
//     moment = −k·(θ + ω) − c·ω + k·turning,    ω their difference of angular velocities:
// a system of 3 × 3 blocks, block-tridiagonal, symmetric and positive definite.
const Motions& JointImpulses::solve(const Vector& angles, const Vector& turning,
                                    const Motions& free, const Eigen::Matrix2Xd& left,
                                    const Eigen::Matrix2Xd& right) {
  const std::size_t hinges = joints_.size();
  const auto response = [this](std::size_t rod, const Matrix3d& to,
                               const Matrix3d& from) -> Matrix3d {
    const Rod& body = chain_.rods[rod];
    return to * Vector3d(1 / body.mass, 1 / body.mass, 1 / body.inertia).asDiagonal() *
           from.transpose();
  };
  for (std::size_t i = 0; i < hinges; ++i) {
    const auto at = static_cast<Index>(i);
    Joint& joint = joints_[i];
    const double rigidity = spring_[at] + dashpot_[at];
    const Matrix3d end = motion_at(right.col(at)), start = motion_at(left.col(at + 1));
    Matrix3d own = response(i, end, end) + response(i + 1, start, start);
    own(2, 2) += 1 / rigidity;
    Vector3d needed = end * free.col(at) - start * free.col(at + 1);
    needed[2] += spring_[at] * (turning[at] - angles[at]) / rigidity;
    if (i > 0) {
      const Joint& before = joints_[i - 1];
      const Matrix3d eliminated = before.coupling.transpose() * before.inverse;
      own -= eliminated * before.coupling;
      needed -= eliminated * before.impulse;
    }
    joint.inverse = own.inverse();
    joint.impulse = needed;
    if (i + 1 < hinges) joint.coupling = -response(i + 1, start, motion_at(right.col(at + 1)));
  }
  for (std::size_t i = hinges; i-- > 0;) {
    Joint& joint = joints_[i];
    if (i + 1 < hinges) joint.impulse -= joint.coupling * joints_[i + 1].impulse;
    joint.impulse = joint.inverse * joint.impulse;
    impulses_.col(static_cast<Index>(i)) = joint.impulse;
  }
  return impulses_;
}

}  // namespace nuno::box2d
