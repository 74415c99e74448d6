#pragma once

#include <nuno/backend.h>
#include <nuno/optimize.h>

namespace nuno::bench {

/// What a plain chain is launched by.
enum class PlainLaunch {
  paper,  ///< equations (1) and (2): exact for small steps only, so it wants many
  exact   ///< our form of them, solved for the chain's own recurrence: its centroid arrives
};

/// The paper's own chain, as one writes it down: explicit springs, semi-implicit Euler, std::sqrt
/// and std::atan2, one double at a time. The problem must outlive it.
class PlainChain {
 public:
  PlainChain(const Problem& problem, Index steps, PlainLaunch launch);

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
