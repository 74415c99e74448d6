#pragma once

#include <nuno/problem.h>

#include <cmath>

namespace nuno {

/// A problem with exactly these particles; nothing pulls or brakes it unless `cloth` says so.
inline Problem problem_of(const Points& positions, double gravity = 0,
                          const Cloth& cloth = {.air_drag = 0, .hinge_stiffness = 0}) {
  const Index n = positions.cols();
  Problem problem;
  problem.chain.initial = positions;
  problem.chain.rest_length = segment_lengths(positions);
  problem.chain.hinge_length =
      0.5 * (problem.chain.rest_length.head(n - 2) + problem.chain.rest_length.tail(n - 2));
  problem.chain.length = problem.chain.rest_length.sum();
  problem.chain.particle_mass = cloth.mass / static_cast<double>(n);
  problem.chain.particle_drag = cloth.air_drag / static_cast<double>(n);
  problem.chain.gravity = gravity;
  problem.chain.cloth = cloth;
  problem.target = positions;
  problem.arrival_time = 1;
  return problem;
}

/// Three particles around a hinge that turns by `angle`, on segments of these lengths.
inline Points bent(double angle, double before = 0.5, double after = 0.3) {
  return Points{{-before, 0, after * std::cos(angle)}, {0, 0, after * std::sin(angle)}};
}

}  // namespace nuno
