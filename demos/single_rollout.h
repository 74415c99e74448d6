#pragma once

#include <nuno/backend.h>

#include <optional>
#include <string>

#include <nuno/engines.h>
#include <nuno/result_file.h>
#include "commands.h"

namespace nuno {

/// Searches the gain that the options ask for in this scene, in place of the options' own, and
/// flies at it.
ExitStatus optimize(const SceneFile& file, const OptimizeOptions& options);

/// Flies once, writes the result or the animation to `out` and tells people what happened, or why
/// the flight diverged.
ExitStatus fly(const SceneFile& file, const Backend& backend, const Gains& gains,
               const std::string& out, const AnimationOptions& animation,
               const std::optional<Optimization>& optimization = std::nullopt);

}  // namespace nuno
