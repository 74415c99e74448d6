#pragma once

#include <nuno/backend.h>

namespace nuno::native {

/// The paper's mass-spring chain (§ 3.1) in double precision.
///
/// The time step is the problem's or, without a wish, the engine's own choice; either way it is
/// cut to what is stable for the chain's stiffness and mass, and to a whole number of steps.
std::unique_ptr<Backend> make_backend(const Problem& problem);

}  // namespace nuno::native
