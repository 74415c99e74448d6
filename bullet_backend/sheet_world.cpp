// Bullet first: its headers and Eigen's fall out over a name in any other order.
#include "sheet_forces.h"

#include <BulletCollision/BroadphaseCollision/btSimpleBroadphase.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>

#include "sheet_world.h"

#include <vector>

namespace nuno::bullet {
namespace {

btScalar narrow(double value) { return static_cast<btScalar>(value); }
btVector3 narrow(const Eigen::Vector3d& v) { return {narrow(v.x()), narrow(v.y()), narrow(v.z())}; }
Eigen::Vector3d widen(const btVector3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

std::unique_ptr<btSoftBody> make_body(btSoftBodyWorldInfo& info, const UnitSheet& sheet,
                                      const Points& positions, const Points& velocities) {
  std::vector<btVector3> x;
  std::vector<btScalar> masses;
  for (Index i = 0; i < positions.cols(); ++i) {
    x.push_back(narrow(positions.col(i)));
    masses.push_back(narrow(sheet.mass[i]));
  }
  auto body =
      std::make_unique<btSoftBody>(&info, static_cast<int>(x.size()), x.data(), masses.data());
  for (int i = 0; i < body->m_nodes.size(); ++i) {
    body->m_nodes[i].m_v = body->m_nodes[i].m_vn = narrow(velocities.col(i));
  }
  // Nothing collides and nothing sleeps. Bullet moves no node by more than the diagonal of the
  // body's box a step; with a margin of L on every side the box is larger than any step here.
  body->m_cfg.collisions = 0;
  body->m_ndbvt.clear();
  body->m_sleepingThreshold = 0;
  body->setActivationState(DISABLE_DEACTIVATION);
  body->getCollisionShape()->setMargin(1);
  return body;
}

}  // namespace

struct SheetWorld::World {
  World(const UnitSheet& sheet, const Points& positions, const Points& velocities)
      : dispatcher(&configuration),
        world(&dispatcher, &broadphase, &constraints, &configuration, &solver),
        springs(sheet.springs),
        hinges(sheet.hinges),
        outer(positions.cols()),
        body(make_body(world.getWorldInfo(), sheet, positions, velocities)) {
    constraints.setDeformableSolver(&solver);
    world.setImplicit(false);
    world.addSoftBody(body.get());
    world.addForce(body.get(), &springs);
    world.addForce(body.get(), &hinges);
    world.addForce(body.get(), &outer);
  }
  ~World() { world.removeSoftBody(body.get()); }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btSimpleBroadphase broadphase;
  btDeformableBodySolver solver;
  btDeformableMultiBodyConstraintSolver constraints;
  btDeformableMultiBodyDynamicsWorld world;
  SpringForce springs;
  HingeForce hinges;
  OuterForce outer;
  std::unique_ptr<btSoftBody> body;
};

SheetWorld::SheetWorld(const UnitSheet& sheet, const Points& positions, const Points& velocities)
    : world_(std::make_unique<World>(sheet, positions, velocities)) {}

SheetWorld::~SheetWorld() = default;

bool SheetWorld::step(const Points& forces, const Kick& kick) {
  for (Index i = 0; i < forces.cols(); ++i) world_->outer.push(i, narrow(forces.col(i)));
  world_->springs.set_kick(kick.kick);
  world_->hinges.set_kick(kick.kick);
  world_->outer.set_kick(kick.kick);
  world_->outer.set_keep(kick.keep);
  world_->world.stepSimulation(1, 0);
  return !world_->outer.is_wild();
}

void SheetWorld::read(Points& positions, Points& velocities) const {
  for (int i = 0; i < world_->body->m_nodes.size(); ++i) {
    const btSoftBody::Node& node = world_->body->m_nodes[i];
    positions.col(i) = widen(node.m_x);
    velocities.col(i) = widen(node.m_v);
  }
}

}  // namespace nuno::bullet
