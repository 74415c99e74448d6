// nuno-sheets DIR: writes the sheets of the scene library, for demos/scenes/sheets.

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "sheet_library.h"

namespace {

using nuno::Index;

/// Wavefront OBJ: doubles that read back exactly; indices count from 1.
std::string obj(const nuno::Points& vertices, const nuno::Faces& faces) {
  std::string text;
  for (Index i = 0; i < vertices.cols(); ++i) {
    text += fmt::format("v {} {} {}\n", vertices(0, i), vertices(1, i), vertices(2, i));
  }
  for (const auto& face : faces) {
    text += 'f';
    for (const Index i : face) text += fmt::format(" {}", i + 1);
    text += '\n';
  }
  return text;
}

std::string json(const nuno::SheetScene& scene) {
  return fmt::format(R"({{
  "nuno_scene": 1,
  "name": "{0}",
  "arrival_time": {1},
  "initial": "{0}-start.obj",
  "target": "{0}-target.obj",
  "reference": "morph",
  "damping_ratio": {2}
}}
)",
                     scene.name, scene.arrival_time, scene.damping_ratio);
}

bool write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (file.flush()) return true;
  fmt::print(stderr, "{}: cannot be written\n", path.string());
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || argv[1][0] == '-') {
    fmt::print(stderr, "usage: nuno-sheets DIR    (writes scenes and their meshes into it)\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const nuno::SheetScene& scene : nuno::scene_library::sheets()) {
    const bool written =
        write(folder / (scene.name + ".json"), json(scene)) &&
        write(folder / (scene.name + "-start.obj"), obj(scene.initial, scene.faces)) &&
        write(folder / (scene.name + "-target.obj"), obj(scene.target, scene.faces));
    if (!written) return 1;
  }
}
