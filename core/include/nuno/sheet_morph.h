#pragma once

#include <nuno/problem.h>

#include <memory>

namespace nuno {

/// A sheet's motion from its initial shape to the target. Each triangle is taken from one to the
/// other by F = R·S: R turns by its own rotation vector, one branch all over the mesh, and S goes
/// linearly, so that the strain on the way is the target's own. The vertices follow by a Poisson
/// solve (cotangent weights, factored once) about the mass centre, at samples of s that are joined
/// by cubics.
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
  double time_ = 0;  ///< t/t₀
};

}  // namespace nuno
