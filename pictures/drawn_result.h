#pragma once

#include <string>

#include "pictures/flight_figure.h"

namespace nuno {

/// Whether a file says at its start that it is a scene.
bool is_scene_file(const std::string& path);

/// Reads and validates a result file. Throws InputError with file, pointer, value and rule.
figures::Flight read_result(const std::string& path);

}  // namespace nuno
