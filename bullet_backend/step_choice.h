#pragma once

#include <nuno/problem.h>

namespace nuno::bullet {

/// The steps of a flight: those of the problem's time step or of the default, more where the sheet
/// is not stable at them. Throws InputError for a step that is not > 0 and for more than
/// most_steps.
Index count_steps(const Problem& problem);

}  // namespace nuno::bullet
