#pragma once

#include <nuno/box2d.h>

namespace nuno::box2d {

/// The steps of a flight: those of the problem's time step or of the default, more where the cloth
/// is not stable at them. Throws InputError for a step that is not > 0 and for more than
/// most_steps.
Index count_steps(const Problem& problem, Hinge form);

}  // namespace nuno::box2d
