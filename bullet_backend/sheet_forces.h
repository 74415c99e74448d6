#pragma once

#include <BulletSoftBody/btDeformableLagrangianForce.h>  // before Eigen, whose names it takes

#include "unit_sheet.h"

#include <vector>

namespace nuno::bullet {

/// A force that Bullet's deformable world takes explicitly, where its step begins: with v from half
/// a step before, so that Bullet's v ← v + f/m, x ← x + v is the leapfrog.
class ExplicitForce : public btDeformableLagrangianForce {
 public:
  void addScaledForces(btScalar scale, TVStack& force) final {
    addScaledExplicitForce(scale, force);
  }
  // Nothing of it is left for Bullet's implicit solver.
  void addScaledDampingForce(btScalar, TVStack&) final {}
  void addScaledDampingForceDifferential(btScalar, const TVStack&, TVStack&) final {}
  void buildDampingForceDifferentialDiagonal(btScalar, TVStack&) final {}
  void addScaledElasticForceDifferential(btScalar, const TVStack&, TVStack&) final {}

  /// Which of Bullet's own forces it stands in for: a world has one of each type.
  btDeformableLagrangianForceType getForceType() final { return type_; }

  void set_kick(double kick) { kick_ = static_cast<btScalar>(kick); }

 protected:
  explicit ExplicitForce(btDeformableLagrangianForceType type) : type_(type) {}

  const btSoftBody::tNodeArray& nodes() const { return m_softBodies[0]->m_nodes; }
  btScalar kick() const { return kick_; }

 private:
  btDeformableLagrangianForceType type_;
  btScalar kick_ = 1;
};

/// Stretch and shear. Bullet's own springs all have one stiffness.
class SpringForce final : public ExplicitForce {
 public:
  explicit SpringForce(const Springs& springs);
  void addScaledExplicitForce(btScalar scale, TVStack& force) override;

 private:
  struct Spring {
    int a, b;
    btScalar rest_length, stiffness, damping;
  };
  std::vector<Spring> springs_;
};

/// Bending, which Bullet knows as springs only.
class HingeForce final : public ExplicitForce {
 public:
  explicit HingeForce(const Hinges& hinges);
  void addScaledExplicitForce(btScalar scale, TVStack& force) override;

 private:
  struct Hinge {
    int a, b, c, d;
    btScalar rest_angle, stiffness, damping;
  };
  std::vector<Hinge> hinges_;
};

/// Drag and what acts from outside; the last force of a world, since it sees the sum of all.
class OuterForce final : public ExplicitForce {
 public:
  explicit OuterForce(Index particles);

  void set_keep(double keep) { loss_ = static_cast<btScalar>(1 - keep); }
  void push(Index particle, const btVector3& force) {
    forces_[static_cast<std::size_t>(particle)] = force;
  }

  void addScaledExplicitForce(btScalar scale, TVStack& force) override;

  /// Whether a node would have moved further in a step than Bullet may be asked to: if so, none
  /// has been pushed.
  bool is_wild() const { return is_wild_; }

 private:
  std::vector<btVector3> forces_;
  btScalar loss_ = 0;
  bool is_wild_ = false;
};

}  // namespace nuno::bullet
