#pragma once

#include <string>

#include "pictures/flight_figure.h"

namespace nuno {

/// Whether what is in the file at `path` says that it is a scene. Throws InputError for no JSON.
bool is_scene(const std::string& text, const std::string& path);

/// Reads and validates what is in a result file. Throws InputError with file, pointer, value and
/// rule.
figures::Flight parse_result(const std::string& text, const std::string& path);

}  // namespace nuno
