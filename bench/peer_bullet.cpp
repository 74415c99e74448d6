// Bullet's soft-body rope: position-based links between neighbours and, for bending, between every
// other node; single precision, 4 iterations (its own rope demo's). A link's stiffness is a number
// from 0 to 1, so its bending cannot be given this chain's.

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <limits>
#include <memory>
#include <vector>

#include "peers.h"

namespace nuno::bench {
namespace {

btScalar narrow(double value) { return static_cast<btScalar>(value); }

Points fly(const Problem& problem, Index steps) {
  const Chain& chain = problem.chain();
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity({0, -narrow(chain.gravity), 0});
  world.getWorldInfo().m_gravity = world.getGravity();

  // Straight first, for the links' rest lengths; then where the scene has it.
  const auto count = static_cast<int>(chain.particles());
  btAlignedObjectArray<btVector3> straight;
  btAlignedObjectArray<btScalar> masses;
  double along = 0;
  for (int i = 0; i < count; ++i) {
    straight.push_back({narrow(along), 0, 0});
    masses.push_back(narrow(chain.particle_mass));
    if (i + 1 < count) along += chain.rest_length[i];
  }
  auto* rope = new btSoftBody(&world.getWorldInfo(), count, &straight[0], &masses[0]);
  for (int i = 0; i + 1 < count; ++i) rope->appendLink(i, i + 1);
  btSoftBody::Material* bending = rope->appendMaterial();
  bending->m_kLST = btScalar(0.1);
  rope->generateBendingConstraints(2, bending);
  rope->m_cfg.piterations = 4;
  rope->m_cfg.collisions = 0;
  for (int i = 0; i < count; ++i) {
    btSoftBody::Node& node = rope->m_nodes[i];
    node.m_x = node.m_q = {narrow(chain.initial(0, i)), narrow(chain.initial(1, i)), 0};
  }
  world.addSoftBody(rope);

  const btScalar h = narrow(problem.arrival_time / static_cast<double>(steps));
  for (Index step = 0; step < steps; ++step) world.stepSimulation(h, 0);
  Points positions(2, chain.particles());
  for (int i = 0; i < count; ++i) {
    const btVector3& x = rope->m_nodes[i].m_x;
    positions.col(i) << static_cast<double>(x.x()), static_cast<double>(x.y());
  }
  world.removeSoftBody(rope);
  delete rope;
  return positions;
}

/// The sheet with links along its edges and across its quads, and between every other node to keep
/// it from folding; mass, place and rest are the scene's.
std::unique_ptr<btSoftBody> make_sheet_body(btSoftBodyWorldInfo& info, const Sheet& sheet) {
  std::vector<btVector3> x;
  std::vector<btScalar> masses;
  for (Index i = 0; i < sheet.particles(); ++i) {
    x.push_back(
        {narrow(sheet.initial(0, i)), narrow(sheet.initial(1, i)), narrow(sheet.initial(2, i))});
    masses.push_back(narrow(sheet.particle_mass * sheet.relative_mass[i]));
  }
  auto body =
      std::make_unique<btSoftBody>(&info, static_cast<int>(x.size()), x.data(), masses.data());
  for (const Springs* springs : {&sheet.stretch, &sheet.shear}) {
    for (Index e = 0; e < springs->count(); ++e) {
      body->appendLink(static_cast<int>(springs->ends(0, e)),
                       static_cast<int>(springs->ends(1, e)));
    }
  }
  body->m_cfg.collisions = 0;
  body->m_sleepingThreshold = 0;
  body->setActivationState(DISABLE_DEACTIVATION);
  return body;
}

Points positions_of(const btSoftBody& body) {
  Points positions(3, body.m_nodes.size());
  for (int i = 0; i < body.m_nodes.size(); ++i) {
    const btVector3& x = body.m_nodes[i].m_x;
    positions.col(i) << static_cast<double>(x.x()), static_cast<double>(x.y()),
        static_cast<double>(x.z());
  }
  return positions;
}

/// Position-based links, 4 iterations.
Points fly_position_based(const Problem& problem, Index steps) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity({0, -narrow(problem.cloth().gravity), 0});
  world.getWorldInfo().m_gravity = world.getGravity();
  const auto body = make_sheet_body(world.getWorldInfo(), problem.sheet());
  btSoftBody::Material* bending = body->appendMaterial();
  bending->m_kLST = btScalar(0.1);
  body->generateBendingConstraints(2, bending);
  body->m_cfg.piterations = 4;
  world.addSoftBody(body.get());
  const btScalar h = narrow(problem.arrival_time / static_cast<double>(steps));
  for (Index step = 0; step < steps; ++step) world.stepSimulation(h, 0);
  const Points positions = positions_of(*body);
  world.removeSoftBody(body.get());
  return positions;
}

/// The deformable world's own mass-spring force, explicit, as most of its demos take it.
Points fly_deformable(const Problem& problem, Index steps) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btDeformableBodySolver deformables;
  btDeformableMultiBodyConstraintSolver solver;
  solver.setDeformableSolver(&deformables);
  btDeformableMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration,
                                           &deformables);
  const btVector3 gravity(0, -narrow(problem.cloth().gravity), 0);
  world.setGravity(gravity);
  world.getWorldInfo().m_gravity = gravity;
  world.setImplicit(false);
  const auto body = make_sheet_body(world.getWorldInfo(), problem.sheet());
  body->generateBendingConstraints(2);
  btDeformableMassSpringForce springs(narrow(problem.sheet().material.stretch_stiffness),
                                      narrow(problem.sheet().material.stretch_damping), true);
  btDeformableGravityForce weight(gravity);
  world.addSoftBody(body.get());
  world.addForce(body.get(), &springs);
  world.addForce(body.get(), &weight);
  const btScalar h = narrow(problem.arrival_time / static_cast<double>(steps));
  for (Index step = 0; step < steps; ++step) world.stepSimulation(h, 1, h);
  const Points positions = positions_of(*body);
  world.removeSoftBody(body.get());
  return positions;
}

}  // namespace

std::vector<Peer> bullet_sheet_peers(const Problem& problem) {
  constexpr Index some = 400, many = 8000;
  constexpr double any_shape = std::numeric_limits<double>::infinity();
  return {{"Bullet soft body, position-based, 4 iterations", any_shape,
           [&problem] { return fly_position_based(problem, some); }, some},
          {"Bullet deformable, its own springs", any_shape,
           [&problem] { return fly_deformable(problem, many); }, many}};
}

std::vector<Peer> bullet_peers(const Problem& problem, Index steps) {
  return {{"Bullet soft-body rope, 4 iterations", std::numeric_limits<double>::infinity(),
           [&problem, steps] { return fly(problem, steps); }}};
}

}  // namespace nuno::bench
