#pragma once

#include <nuno/backend.h>

#include <optional>
#include <string>

#include <nuno/engines.h>
#include <nuno/result_file.h>
#include "commands.h"

namespace nuno {

/// Throws InputError or OutputError, before any work is done, where a result of this scene would
/// not have room for its frames, in memory and at `out` (none if that is empty), or the kind of
/// file does not hold such a cloth.
void require_room(const SceneFile& file, const std::string& out);

/// Searches the gain that the options ask for in this scene, in place of the options' own, and
/// flies at it.
ExitStatus optimize(SceneFile file, const OptimizeOptions& options);

/// Flies once, writes the result to `out` and tells people what happened, or why the flight
/// diverged.
ExitStatus fly(const SceneFile& file, const Backend& backend, const Gains& gains,
               const std::string& out,
               const std::optional<Optimization>& optimization = std::nullopt);

}  // namespace nuno
