#pragma once

#include <string>

#include "../figures/flight_figure.h"

namespace nuno {

/// Whether a file is a result, and not a scene: it says so in its first bytes of JSON.
bool is_scene_file(const std::string& path);

/// Reads and validates a result file. Throws InputError with file, pointer, value and rule.
figures::Flight read_result(const std::string& path);

}  // namespace nuno
