#pragma once

#include <nuno/backend.h>

#include <optional>

namespace nuno::native {

/// The paper's mass-spring chain (§ 3.1) in double precision.
///
/// The time step is the wished one or, without a wish, the engine's own choice; either way it is
/// cut to what is stable for the chain's stiffness and mass, and to a whole number of steps.
std::unique_ptr<Backend> make_backend(const Problem& problem,
                                      std::optional<double> time_step = std::nullopt);

}  // namespace nuno::native
