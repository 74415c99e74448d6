#pragma once

#include <nuno/problem.h>

#include <memory>

namespace nuno {

/// A sheet's motion from its initial shape to the target. Each triangle is taken from one to the
/// other by F = R·S. S goes linearly, so that the strain on the way is the target's own wherever
/// the turns of the triangles fit together. They turn, by R, so that neighbours turn against each
/// other steadily: any number of times in a roll, less than half a turn at an edge; the whole turns
/// by the mean of what is left, the shorter way. The vertices follow by a Poisson solve (cotangent
/// weights, factored once) about the mass centre, at 33 samples of s that a cubic spline joins.
/// A rigid motion is that rotation at a steady rate.
///
/// A way that is curved one way, then another (a roll about one axis to a roll about a second one)
/// is curved both ways in between, which stretches it: no sheet could go there directly.
///
/// A copyable value; copies share the samples.
class SheetMorph {
 public:
  /// Of a problem with a sheet; `step_time` is a step's share of t₀.
  SheetMorph(const Problem& problem, double step_time);

  Points shape() const;              ///< about its mass centre [3 × N], m
  Points velocity_at_start() const;  ///< of the motion itself at t = 0 [3 × N], m/s

  /// Goes on by one time step.
  void advance();

 private:
  struct Samples;
  std::shared_ptr<const Samples> samples_;
  bool settles_ = false;
  double start_rate_ = 0;  ///< ds/dt at t = 0 [1/s]
  double step_time_ = 0;
  Index step_ = 0;  ///< steps since t = 0
};

}  // namespace nuno
