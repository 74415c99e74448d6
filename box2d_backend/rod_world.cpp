#include "rod_world.h"

#include <box2d/box2d.h>

#include <algorithm>

namespace nuno::box2d {
namespace {

using Eigen::Vector2d;

float narrow(double value) { return static_cast<float>(value); }
b2Vec2 narrow(const Vector2d& v) { return {narrow(v.x()), narrow(v.y())}; }
Vector2d widen(const b2Vec2& v) { return {static_cast<double>(v.x), static_cast<double>(v.y)}; }

std::size_t index(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

// Box2D solves joints from the last body of the chain to the first, and at a hinge the joint that
// was made last comes first: springs, then the revolute joint.
RodWorld::RodWorld(const RodChain& chain, double half_kick)
    : world_(std::make_unique<b2World>(b2Vec2(0, 0))) {
  world_->SetAllowSleeping(false);
  world_->SetContinuousPhysics(false);
  for (const Rod& rod : chain.rods) {
    b2BodyDef def;
    def.type = b2_dynamicBody;
    def.allowSleep = false;
    b2Body* body = world_->CreateBody(&def);
    b2MassData mass;
    mass.mass = narrow(rod.mass);
    mass.center.SetZero();
    mass.I = narrow(rod.inertia);
    body->SetMassData(&mass);
    bodies_.push_back(body);
    if (bodies_.size() > 1) joints_.push_back(join(chain, half_kick, bodies_.size() - 2));
  }
}

RodWorld::~RodWorld() = default;

// A soft joint's impulse over Box2D's step of 1 is −k·(C + Ċ) − c·Ċ, what chain_simulation.cpp
// takes a part of back. Half a kick, so half the spring: q·k.
b2Joint* RodWorld::join(const RodChain& chain, double half_kick, std::size_t i) {
  constexpr double nothing = 1e-20;  // no moment to speak of, and its reciprocal is finite
  const HingeSpring& hinge = chain.hinges[i];
  const bool has_spring =
      !chain.solves_joints && std::max(hinge.stiffness, hinge.damping) > nothing;
  // A joint of no stiffness would be rigid: a lone dashpot gets a spring for form's sake.
  const double k = half_kick * std::max(hinge.stiffness, nothing);
  const double c = half_kick * hinge.damping;
  const double end = chain.rods[i].right;
  const double start = chain.rods[i + 1].left;

  if (has_spring && chain.hinge == Hinge::soft_weld) {
    b2WeldJointDef weld;
    weld.bodyA = bodies_[i];
    weld.bodyB = bodies_[i + 1];
    weld.localAnchorA = {narrow(end), 0};
    weld.localAnchorB = {narrow(start), 0};
    weld.stiffness = narrow(k);
    weld.damping = narrow(c);
    return world_->CreateJoint(&weld);
  }

  b2RevoluteJointDef pivot;
  pivot.bodyA = bodies_[i];
  pivot.bodyB = bodies_[i + 1];
  pivot.localAnchorA = {narrow(end), 0};
  pivot.localAnchorB = {narrow(start), 0};
  b2Joint* revolute = world_->CreateJoint(&pivot);
  if (!has_spring) return revolute;
  for (const double side : {hinge.aside, -hinge.aside}) {
    b2DistanceJointDef spring;
    spring.bodyA = bodies_[i];
    spring.bodyB = bodies_[i + 1];
    spring.localAnchorA = {narrow(end - hinge.along), narrow(side)};
    spring.localAnchorB = {narrow(start + hinge.along), narrow(side)};
    spring.length = narrow(2 * hinge.along);
    spring.maxLength = 2 * spring.length;  // the outer spring never gets past 1.4 of it
    spring.stiffness = narrow(k);
    spring.damping = narrow(c);
    world_->CreateJoint(&spring);
  }
  return revolute;
}

void RodWorld::push(Index rod, const Vector2d& force, double torque) {
  bodies_[index(rod)]->ApplyForceToCenter(narrow(force), false);
  bodies_[index(rod)]->ApplyTorque(narrow(torque), false);
}

RodWorld::Step RodWorld::step(const Motions& poses, const Motions& velocities,
                              int velocity_iterations, int position_iterations) {
  const Eigen::Matrix3Xf handed = poses.cast<float>();
  for (Index i = 0; i < poses.cols(); ++i) {
    b2Body& body = *bodies_[index(i)];
    body.SetTransform({handed(0, i), handed(1, i)}, handed(2, i));
    body.SetLinearVelocity(narrow(velocities.col(i).head<2>()));
    body.SetAngularVelocity(narrow(velocities(2, i)));
  }

  world_->Step(1, velocity_iterations, position_iterations);

  Step result{Motions(3, poses.cols()), Motions(3, poses.cols()),
              Eigen::Matrix2Xd(2, poses.cols() - 1)};
  for (Index i = 0; i < poses.cols(); ++i) {
    const b2Body& body = *bodies_[index(i)];
    const b2Vec2& v = body.GetLinearVelocity();
    const Eigen::Vector3f velocity(v.x, v.y, body.GetAngularVelocity());
    const b2Vec2& x = body.GetPosition();
    const Eigen::Vector3f pose(x.x, x.y, body.GetAngle());
    const Eigen::Vector3f moved = handed.col(i) + velocity;  // x + h·v as Box2D rounds it
    result.velocities.col(i) = velocity.cast<double>();
    result.corrections.col(i) = (pose - moved).cast<double>();
  }
  for (Index i = 0; i + 1 < poses.cols(); ++i) {
    result.impulses.col(i) = widen(joints_[index(i)]->GetReactionForce(1));
  }
  return result;
}

}  // namespace nuno::box2d
