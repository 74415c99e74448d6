// nuno-family DIR: writes the seeded family of scenes, for nuno compare DIR.

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include <nuno/scene_file.h>

#include "scene_library.h"

int main(int argc, char** argv) {
  constexpr int scenes = 64;
  if (argc != 2 || argv[1][0] == '-') {
    fmt::print(stderr, "usage: nuno-family DIR    (writes {} scenes into it)\n", scenes);
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const nuno::ChainScene& scene : nuno::scene_library::family(scenes)) {
    const std::filesystem::path path = folder / (scene.name + ".json");
    std::ofstream file(path);
    file << nuno::to_json(scene) << '\n';
    if (!file.flush()) {
      fmt::print(stderr, "{}: cannot be written\n", path.string());
      return 1;
    }
  }
}
