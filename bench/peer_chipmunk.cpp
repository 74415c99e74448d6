// Chipmunk 7: rods on pivot joints with damped rotary springs, double precision, 10 iterations (its
// default).

#include <chipmunk/chipmunk.h>

#include <cmath>

#include "peers.h"

namespace nuno::bench {
namespace {

Points fly(const Problem& problem, Index steps) {
  const Chain& chain = problem.chain();
  const std::vector<Rod> rod = rods(chain);
  cpSpace* space = cpSpaceNew();
  cpSpaceSetGravity(space, cpv(0, -chain.gravity));
  std::vector<cpBody*> bodies;
  std::vector<cpConstraint*> joints;
  double turned = 0;  // a body's angle is unwound: neighbours differ by the hinge's angle
  for (std::size_t i = 0; i < rod.size(); ++i) {
    const auto column = static_cast<Index>(i);
    const Vector span = chain.initial.col(column + 1) - chain.initial.col(column);
    cpBody* body = cpSpaceAddBody(space, cpBodyNew(rod[i].mass, rod[i].inertia));
    const double angle = std::atan2(span[1], span[0]);
    turned = i == 0 ? angle : turned + std::remainder(angle - turned, 2 * M_PI);
    const Vector center = chain.initial.col(column) + rod[i].center / rod[i].length * span;
    cpBodySetPosition(body, cpv(center[0], center[1]));
    cpBodySetAngle(body, turned);
    if (i > 0) {
      const cpVect before = cpv(rod[i - 1].length - rod[i - 1].center, 0);
      const cpVect here = cpv(-rod[i].center, 0);
      joints.push_back(
          cpSpaceAddConstraint(space, cpPivotJointNew2(bodies.back(), body, before, here)));
      const double stiffness = chain.material.hinge_stiffness / chain.hinge_length[column - 1];
      joints.push_back(cpSpaceAddConstraint(
          space, cpDampedRotarySpringNew(bodies.back(), body, 0, stiffness, 0)));
    }
    bodies.push_back(body);
  }
  const double h = problem.arrival_time / static_cast<double>(steps);
  for (Index step = 0; step < steps; ++step) cpSpaceStep(space, h);

  Points positions(2, chain.particles());
  for (std::size_t i = 0; i < rod.size(); ++i) {
    const auto column = static_cast<Index>(i);
    const cpVect first = cpBodyLocalToWorld(bodies[i], cpv(-rod[i].center, 0));
    const cpVect second = cpBodyLocalToWorld(bodies[i], cpv(rod[i].length - rod[i].center, 0));
    positions.col(column) << first.x, first.y;
    positions.col(column + 1) << second.x, second.y;
  }
  for (cpConstraint* joint : joints) {
    cpSpaceRemoveConstraint(space, joint);
    cpConstraintFree(joint);
  }
  for (cpBody* body : bodies) {
    cpSpaceRemoveBody(space, body);
    cpBodyFree(body);
  }
  cpSpaceFree(space);
  return positions;
}

}  // namespace

std::vector<Peer> chipmunk_peers(const Problem& problem, Index steps) {
  return {{"Chipmunk 7, pivots and rotary springs, 10 iterations", 0.05,
           [&problem, steps] { return fly(problem, steps); }}};
}

}  // namespace nuno::bench
