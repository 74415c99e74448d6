#pragma once

#include <nuno/rollout_gradient.h>

#include "sheet_kernel.h"

namespace nuno::native {

// The two halves of `step`, and each of them backwards (reverse mode): what a quantity gains by a
// change of the state before, from what it gains by one of the state after. All in the plan's
// order.

/// Derivatives of a quantity with respect to a SheetState, per unit of each.
struct SheetCotangent {
  std::vector<double> positions;  ///< [3 × N], 1/m
  std::vector<double> impulse;    ///< [3 × N], 1/N
  std::vector<double> length;     ///< [springs], 1/m; or empty, as in the state
  std::vector<double> turn;       ///< [hinges]; or empty
};

/// What the substeps of one step started from.
struct SubstepTape {
  std::vector<double> positions;  ///< [3 × N × substeps], m
  std::vector<double> length;     ///< [springs × substeps], m; or empty
};

/// The slow forces of a step: hinges, and these [3 × N], N, in the problem's order.
void kick(const SheetPlan& plan, const Points& forces, SheetState& state);

/// The substeps of a step after its kick. Where `tape` is not null, it gets what they started from.
void swing(const SheetPlan& plan, SheetState& state, SubstepTape* tape);

/// Substeps backwards; `first`: those of the first step.
void swing_back(const SheetPlan& plan, bool first, const SubstepTape& tape,
                SheetCotangent& cotangent);

/// The hinges' kick backwards, at the positions [3 × N] that it was given at. `turn` is that of the
/// state before; empty where there are no dashpots.
void kick_back(const SheetPlan& plan, bool first, const std::vector<double>& positions,
               const std::vector<double>& turn, SheetCotangent& cotangent);

/// θ − θ₀ of the hinges at these positions [3 × N].
void turns_at(const SheetPlan& plan, const std::vector<double>& positions,
              std::vector<double>& turn);

/// `begin` backwards: adds what a quantity gains by the velocities at the start [3 × N], per m/s,
/// but for what it gains by the state's own.
void begin_back(const SheetPlan& plan, const std::vector<double>& positions,
                const SheetCotangent& cotangent, std::vector<double>& velocities);

// ---- whole flights ----------------------------------------------------------------------------

/// The flight of `fly` at this gain from `start`, and the gradient of a quantity of it. But for the
/// launch by which a correction of the reference counts as well: see RolloutGradient.
RolloutGradient fly_back(const SheetPlan& plan, const Problem& problem, const SheetState& start,
                         double gain, const CotangentAt& cotangent_at);

}  // namespace nuno::native
