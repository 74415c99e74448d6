#pragma once

#include <nuno/backend.h>
#include <nuno/optimize.h>

namespace nuno::bench {

/// The paper's own procedure, as one writes it down: a mass-spring chain with explicit springs,
/// semi-implicit Euler, one double at a time. It flies the launch that is solved for its own
/// recurrence, so that its centroid arrives: what the launch costs it in accuracy, ours spares it.
class PlainChain {
 public:
  PlainChain(const Problem& problem, Index steps);

  double error(double gain) const;  ///< E(α) [m]; +∞ where the flight diverged
  /// The same as steepest descent sees it; the chain must outlive it.
  Objective objective() const;
  Index steps() const { return steps_; }

  /// Steps below which the stretch springs or the hinges blow up.
  static Index fewest_steps(const Problem& problem);

 private:
  const Problem& problem_;
  Index steps_;
  Points launch_velocity_;
  Points target_shape_;
};

}  // namespace nuno::bench
