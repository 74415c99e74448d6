#include "scene_paths.h"

#include <nuno/scene.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace nuno {

namespace fs = std::filesystem;

std::vector<std::string> scene_paths(const std::vector<std::string>& paths) {
  std::vector<std::string> result;
  for (const std::string& path : paths) {
    std::error_code error;
    if (!fs::is_directory(path, error)) {
      result.push_back(path);
      continue;
    }
    std::vector<std::string> inside;
    for (auto entry = fs::directory_iterator(path, error); !error && entry != fs::end(entry);
         entry.increment(error)) {
      if (entry->path().extension() == ".json") inside.push_back(entry->path().string());
    }
    if (error) throw InputError(fmt::format("{}: {}", path, error.message()));
    if (inside.empty()) throw InputError(fmt::format("{}: is a folder without a *.json", path));
    std::ranges::sort(inside);
    result.insert(result.end(), inside.begin(), inside.end());
  }
  return result;
}

}  // namespace nuno
