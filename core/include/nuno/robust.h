#pragma once

#include <nuno/optimize.h>

namespace nuno {

struct RobustOptions {
  double size = 1e-3;         ///< of a disturbance: mean displacement at the start, over L, > 0
  unsigned disturbances = 4;  ///< starts beside the undisturbed one, ≥ 1
};

/// E(α) averaged over the flight from the initial shape and flights from disturbed ones (see
/// `disturbed`): a gain at which a hair's breadth at the start decides the answer is worth no more
/// than its neighbours are. Knows no slopes; an error takes disturbances + 1 rollouts, and is +∞
/// where one of them diverges. The backend must outlive it.
Objective robust_objective(const Backend& backend, const RobustOptions& options = {});

}  // namespace nuno
