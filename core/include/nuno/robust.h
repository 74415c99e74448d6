#pragma once

#include <nuno/optimize.h>

namespace nuno {

struct RobustOptions {
  double size = 1e-3;          ///< of a perturbation: mean displacement at the start, over L, > 0
  unsigned perturbations = 4;  ///< starts beside the unperturbed one, ≥ 1
};

/// E(α) averaged over the flight from the initial shape and flights from perturbed ones (see
/// `perturbed`): a gain at which a hair's breadth at the start decides the answer is worth no more
/// than its neighbours are. Knows no derivatives; an error takes perturbations + 1 rollouts, and is
/// +∞ where one of them diverges. The backend must outlive it.
Objective robust_objective(const Backend& backend, const RobustOptions& options = {});

}  // namespace nuno
