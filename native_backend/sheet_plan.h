#pragma once

#include "sheet_kernel.h"

namespace nuno::native {

/// The steps that a sheet takes on this engine.
struct SheetSteps {
  Index steps = 0;
  Index substeps = 1;  ///< of the springs, in each step
};

/// The problem's own step, cut to what is stable, and its substeps. Throws InputError where they
/// would be more than most_steps.
SheetSteps choose_steps(const Problem& problem);

SheetPlan make_sheet_plan(const Problem& problem, const SheetSteps& steps);

}  // namespace nuno::native
