#pragma once

#include <nuno/problem.h>

#include <cmath>

namespace nuno {

/// A problem with exactly these particles; nothing pulls or brakes it unless `cloth` says so.
inline Problem problem_of(const Points& positions, double gravity = 0,
                          const ChainMaterial& cloth = {.air_drag = 0, .hinge_stiffness = 0}) {
  Problem problem;
  problem.form = make_chain(positions, cloth, gravity);
  problem.target = positions;
  problem.arrival_time = 1;
  return problem;
}

/// Three particles around a hinge that turns by `angle`, on segments of these lengths.
inline Points bent(double angle, double before = 0.5, double after = 0.3) {
  return Points{{-before, 0, after * std::cos(angle)}, {0, 0, after * std::sin(angle)}};
}

}  // namespace nuno
