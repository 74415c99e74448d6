#pragma once

#include <string>
#include <vector>

namespace nuno {

/// The files among `paths`, and the *.json of the folders among them in alphabetical order. Throws
/// InputError for a folder without any.
std::vector<std::string> scene_paths(const std::vector<std::string>& paths);

}  // namespace nuno
