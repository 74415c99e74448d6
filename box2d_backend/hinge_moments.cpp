#include "hinge_moments.h"

#include <Eigen/LU>
#include <algorithm>

namespace nuno::box2d {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// From a rod's motion to that of a point at r from its centre.
Matrix3d motion_at(const Vector2d& r) {
  Matrix3d result;
  result << 1, 0, -r.y(), 0, 1, r.x(), 0, 0, 1;
  return result;
}

}  // namespace

HingeMoments::HingeMoments(const RodChain& chain, double half_kick)
    : chain_(chain),
      spring_(static_cast<Index>(chain.hinges.size())),
      dashpot_(spring_.size()),
      joints_(chain.hinges.size()),
      moments_(spring_.size()) {
  for (Index i = 0; i < spring_.size(); ++i) {
    const HingeSpring& hinge = chain.hinges[static_cast<std::size_t>(i)];
    spring_[i] = half_kick * hinge.stiffness;
    dashpot_[i] = half_kick * hinge.damping;
  }
}

// With V the rods' motions free of hinges and joints, W their inverse masses and G(r) as above, the
// impulses p (force and moment) at all joints leave the rods with V + W·Gᵀ·p. There
//     the ends of neighbours move alike, and
//     moment = −k·(θ + ω) − c·ω + k·(turning),    ω their difference of angular velocities:
// a block-tridiagonal system, symmetric and positive definite, of 3 × 3 blocks.
const Vector& HingeMoments::solve(const Vector& angles, const Vector& turning, const Motions& free,
                                  const Eigen::Matrix2Xd& left, const Eigen::Matrix2Xd& right) {
  const auto hinges = static_cast<std::size_t>(moments_.size());
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
      const Matrix3d eliminated = before.coupling.transpose() * before.factor;
      own -= eliminated * before.coupling;
      needed -= eliminated * before.impulse;
    }
    joint.factor = own.inverse();
    joint.impulse = needed;
    if (i + 1 < hinges) joint.coupling = -response(i + 1, start, motion_at(right.col(at + 1)));
  }
  for (std::size_t i = hinges; i-- > 0;) {
    Joint& joint = joints_[i];
    if (i + 1 < hinges) joint.impulse -= joint.coupling * joints_[i + 1].impulse;
    joint.impulse = (joint.factor * joint.impulse).eval();
    moments_[static_cast<Index>(i)] = joint.impulse[2];
  }
  return moments_;
}

}  // namespace nuno::box2d
