// Bullet's soft-body rope: position-based links between neighbours and, for bending, between every
// other node; single precision, 4 iterations (its own rope demo's). A link's stiffness is a number
// from 0 to 1, so its bending cannot be given this chain's.

#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <limits>

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

}  // namespace

std::vector<Peer> bullet_peers(const Problem& problem, Index steps) {
  return {{"Bullet soft-body rope, 4 iterations", std::numeric_limits<double>::infinity(),
           [&problem, steps] { return fly(problem, steps); }}};
}

}  // namespace nuno::bench
