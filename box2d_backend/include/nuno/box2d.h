#pragma once

#include <nuno/backend.h>

#include <optional>

namespace nuno::box2d {

/// How a hinge spring is made of Box2D joints.
enum class Hinge {
  spring_pair,  ///< a revolute joint and a soft distance joint on either side of it
  soft_weld     ///< one soft weld joint: revolute joint and linear torsion spring in one
};

struct Options {
  std::optional<double> time_step;   ///< [s], > 0; absent: the engine's default
  Hinge hinge = Hinge::soft_weld;
  int velocity_iterations = 16;      ///< > 0
  int position_iterations = 4;       ///< > 0
};

/// The same cloth as a chain of Box2D rods. Throws InputError for a scene that Box2D cannot hold.
std::unique_ptr<Backend> make_backend(const Problem& problem, const Options& options = {});

}  // namespace nuno::box2d
