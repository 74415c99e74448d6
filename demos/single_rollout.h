#pragma once

#include <nuno/backend.h>

#include <optional>
#include <string>

#include <nuno/engines.h>
#include <nuno/result_file.h>
#include "commands.h"

namespace nuno {

/// Throws InputError or OutputError, before any work is done, where a flight of this scene would
/// not have room for its frames, in memory and at `out` (none if that is empty), or the kind of
/// file does not hold what is asked.
void require_room(const SceneFile& file, const std::string& out, const AnimationOptions& animation);

/// Searches the gain that the options ask for in this scene, in place of the options' own, and
/// flies at it.
ExitStatus optimize(SceneFile file, const OptimizeOptions& options);

/// Flies once, writes the result or the animation to `out` and tells people what happened, or why
/// the flight diverged.
ExitStatus fly(const SceneFile& file, const Backend& backend, const Gains& gains,
               const std::string& out, const AnimationOptions& animation,
               const std::optional<Optimization>& optimization = std::nullopt);

}  // namespace nuno
