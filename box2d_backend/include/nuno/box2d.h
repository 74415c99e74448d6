#pragma once

#include <nuno/backend.h>

#include <memory>

namespace nuno::box2d {

/// How a hinge spring is made of Box2D joints.
enum class Hinge {
  /// A revolute joint and a soft distance joint on either side of it. Follows the hinge's law to
  /// 2 % up to a turning angle of 1.7 rad (97°) and ends there: a scene that starts beyond is
  /// refused, a flight that gets there has diverged. Two to three times as slow.
  spring_pair,
  /// One soft weld joint: revolute joint and linear torsion spring in one, at any angle.
  soft_weld
};

struct Options {
  Hinge hinge = Hinge::soft_weld;
  int velocity_iterations = 8;  ///< > 0; stiff soft welds get more, rigid ones not
  int position_iterations = 4;  ///< > 0
};

/// The same cloth as a chain of Box2D's rods, joints and springs, in single precision but for the
/// poses. Rods do not stretch: `stretch_stiffness` and `stretch_damping` have no effect here, and
/// of launch velocities only what keeps every segment's length is taken (see without_stretching).
///
/// The cloth flies about its mass centre, whose own flight is that of mass_center_flight.h: nothing
/// here depends on how far or how high it is thrown. The time step, the problem's or 1/1000 of the
/// arrival time, is cut to what resolves very stiff hinge springs, to 1/4 of the time that
/// drag takes, to one segment's length of launch about the mass centre, and to a whole number of
/// steps.
///
/// A cloth that moves out of Box2D's range (1.9 mean segments or 1.5 rad per step) has diverged:
/// its positions are NaN from then on. Throws InputError for a scene that Box2D cannot hold: more
/// than 4096 particles, a segment below 1/1000 of the mean, a step that would make more than
/// most_steps.
std::unique_ptr<Backend> make_backend(const Problem& problem);

/// The same with joints and iterations of one's own choice.
std::unique_ptr<Backend> make_backend_with(const Options& options, const Problem& problem);

}  // namespace nuno::box2d
