#pragma once

#include <nuno/backend.h>

namespace nuno::native {

/// The paper's mass-spring chain (§ 3.1) in double precision.
///
/// The time step is the problem's or, without a wish, the engine's own choice, which follows the
/// motion and not the number of particles: where hinges would need far shorter steps, they are
/// implicit. Either way it is cut to what is stable and resolves the cloth's own long waves, and to
/// a whole number of steps.
std::unique_ptr<Backend> make_backend(const Problem& problem);

}  // namespace nuno::native
