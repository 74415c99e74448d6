#pragma once

#include <nuno/problem.h>

#include <functional>
#include <string>
#include <vector>

namespace nuno::bench {

/// Another engine's cloth of the same particles, let go at rest.
struct Peer {
  std::string name;
  /// How far its shape at arrival may be from the native chain's, mean distance over the cloth's
  /// length; +∞ for an engine whose bending has no stiffness in N·m².
  double shape_tolerance = 0;
  std::function<Points()> fly;  ///< the whole flight; positions at arrival [d × N], m
  Index steps = 0;              ///< of it, where each takes its own
};

/// b2Rope's first two, as fast and as exact as its own testbed runs it; then others.
/// The flight is problem.arrival_time long in so many steps; nothing but gravity and the chain's
/// own forces. The problem must outlive them.
std::vector<Peer> b2rope_peers(const Problem& problem, Index steps);
std::vector<Peer> chipmunk_peers(const Problem& problem, Index steps);
std::vector<Peer> bullet_peers(const Problem& problem, Index steps);
std::vector<Peer> mujoco_peers(const Problem& problem, Index steps);

/// Sheets of another engine's own kind, let go at rest: a square of quads. Each takes steps that it
/// is stable and exact at.
std::vector<Peer> bullet_sheet_peers(const Problem& problem);
std::vector<Peer> mujoco_sheet_peers(const Problem& problem);

/// Those of the engines that this program was built with.
std::vector<Peer> peers(const Problem& problem, Index steps);
std::vector<Peer> sheet_peers(const Problem& problem);

/// Rods between neighbouring particles, each with half of the mass of an inner particle at its ends
/// and all of it at a free end: the same mechanical system as the particles on stiff segments.
struct Rod {
  double length = 0;   ///< [m]
  double mass = 0;     ///< [kg]
  double center = 0;   ///< distance of the centre of mass from the first particle [m]
  double inertia = 0;  ///< about the centre of mass [kg·m²]
};
std::vector<Rod> rods(const Chain& chain);

}  // namespace nuno::bench
