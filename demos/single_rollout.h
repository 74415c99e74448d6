#pragma once

#include <nuno/backend.h>

#include <optional>
#include <string>

#include <nuno/engines.h>
#include <nuno/result_file.h>
#include "commands.h"

namespace nuno {

/// A scene whose result goes to `out` (none if that is empty): read, validated, and known to have
/// room for its frames, in memory and at `out`, before any work is done.
SceneFile read_scene_for(const std::string& out, const std::string& path,
                         std::optional<double> time_step);

/// Flies once, writes the result to `out` and tells people what happened, or why the flight
/// diverged.
ExitStatus fly(const SceneFile& file, const Backend& backend, const Gains& gains,
               const std::string& out,
               const std::optional<Optimization>& optimization = std::nullopt);

}  // namespace nuno
