#include "sheet_forces.h"

#include <cmath>

namespace nuno::bullet {
namespace {

int narrow(Index i) { return static_cast<int>(i); }
btScalar narrow(double value) { return static_cast<btScalar>(value); }

}  // namespace

SpringForce::SpringForce(const Springs& springs) : ExplicitForce(BT_MASSSPRING_FORCE) {
  for (Index i = 0; i < springs.count(); ++i) {
    springs_.push_back({narrow(springs.ends(0, i)), narrow(springs.ends(1, i)),
                        narrow(springs.rest_length[i]), narrow(springs.stiffness[i]),
                        narrow(springs.damping[i])});
  }
}

void SpringForce::addScaledExplicitForce(btScalar scale, TVStack& force) {
  scale *= kick();
  for (const Spring& spring : springs_) {
    const btSoftBody::Node& a = nodes()[spring.a];
    const btSoftBody::Node& b = nodes()[spring.b];
    const btVector3 apart = b.m_x - a.m_x;
    const btScalar length = apart.length();
    if (!(length > 0)) continue;  // ends that coincide are pulled nowhere
    const btVector3 along = apart / length;
    const btScalar tension = spring.stiffness * (length - spring.rest_length) +
                             spring.damping * along.dot(b.m_v - a.m_v);
    const btVector3 pull = scale * tension * along;
    force[spring.a] += pull;
    force[spring.b] -= pull;
  }
}

HingeForce::HingeForce(const Hinges& hinges) : ExplicitForce(BT_LINEAR_ELASTICITY_FORCE) {
  for (Index i = 0; i < hinges.count(); ++i) {
    if (hinges.stiffness[i] == 0 && hinges.damping[i] == 0) continue;
    hinges_.push_back({narrow(hinges.corners(0, i)), narrow(hinges.corners(1, i)),
                       narrow(hinges.corners(2, i)), narrow(hinges.corners(3, i)),
                       narrow(hinges.rest_angle[i]), narrow(hinges.stiffness[i]),
                       narrow(hinges.damping[i])});
  }
}

// With e = b − a and the triangles' normals p = e × (c − a) and q = (d − a) × e,
//     ∂θ/∂c = −|e|·p/|p|²,   ∂θ/∂d = −|e|·q/|q|²;
// a triangle that turns about the edge leaves its ends where they are, and one that is moved along
// leaves θ: so with s and t the places of the feet of c and d along the edge, from 0 at a to 1 at
// b,
//     ∂θ/∂a = −(1 − s)·∂θ/∂c − (1 − t)·∂θ/∂d,   ∂θ/∂b = −s·∂θ/∂c − t·∂θ/∂d.
void HingeForce::addScaledExplicitForce(btScalar scale, TVStack& force) {
  scale *= kick();
  for (const Hinge& hinge : hinges_) {
    const btSoftBody::Node& a = nodes()[hinge.a];
    const btSoftBody::Node& b = nodes()[hinge.b];
    const btSoftBody::Node& c = nodes()[hinge.c];
    const btSoftBody::Node& d = nodes()[hinge.d];
    const btVector3 edge = b.m_x - a.m_x;
    const btVector3 to_c = c.m_x - a.m_x, to_d = d.m_x - a.m_x;
    const btVector3 p = edge.cross(to_c), q = to_d.cross(edge);
    const btScalar squared = edge.length2(), length = std::sqrt(squared);
    const btScalar p2 = p.length2(), q2 = q.length2();
    if (!(p2 > 0 && q2 > 0)) continue;  // a triangle without area has no angle
    const btScalar angle = std::atan2(p.cross(q).dot(edge) / length, p.dot(q));

    const btVector3 by_c = -length / p2 * p, by_d = -length / q2 * q;
    const btScalar s = to_c.dot(edge) / squared, t = to_d.dot(edge) / squared;
    const btVector3 by_a = (s - 1) * by_c + (t - 1) * by_d;
    const btVector3 by_b = -s * by_c - t * by_d;
    const btScalar rate = by_a.dot(a.m_v) + by_b.dot(b.m_v) + by_c.dot(c.m_v) + by_d.dot(d.m_v);
    const btScalar moment =
        -scale * (hinge.stiffness * (angle - hinge.rest_angle) + hinge.damping * rate);
    force[hinge.a] += moment * by_a;
    force[hinge.b] += moment * by_b;
    force[hinge.c] += moment * by_c;
    force[hinge.d] += moment * by_d;
  }
}

OuterForce::OuterForce(Index particles)
    : ExplicitForce(BT_GRAVITY_FORCE),
      forces_(static_cast<std::size_t>(particles), btVector3(0, 0, 0)) {}

void OuterForce::addScaledExplicitForce(btScalar scale, TVStack& force) {
  for (int i = 0; i < nodes().size(); ++i) {
    const btSoftBody::Node& node = nodes()[i];
    force[i] +=
        scale * kick() * forces_[static_cast<std::size_t>(i)] - loss_ / node.m_im * node.m_v;
    const btVector3 velocity = node.m_v + node.m_im * force[i];
    if (!(velocity.length2() < 1)) is_wild_ = true;  // so is one that is not a number
  }
  if (!is_wild_) return;
  for (int i = 0; i < force.size(); ++i) force[i].setZero();
}

}  // namespace nuno::bullet
