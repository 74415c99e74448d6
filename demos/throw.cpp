// nuno throw: two meshes in, an animated one out.

#include <fmt/format.h>

#include <filesystem>

#include <nuno/materials.h>
#include <nuno/scene_file.h>
#include "commands.h"
#include "single_rollout.h"

namespace nuno {

ExitStatus throw_cloth(const ThrowOptions& options) {
  const std::string& out = options.out;
  if (!out.empty() && out != "-" && !out.ends_with(".glb") && !out.ends_with(".json")) {
    throw InputError(fmt::format("--out: \"{}\" does not end in .glb or .json", out));
  }
  std::string target = options.target;
  if (target.empty()) {
    if (!may_have_morph_targets(options.start)) {
      throw InputError("TARGET: is missing; only a START of glTF can hold it, as a morph target");
    }
    target = mesh_file(options.start) + "#";  // its only one
  }
  SheetScene scene;
  scene.name = std::filesystem::path(mesh_file(target)).stem().string();
  scene.arrival_time = options.arrival_time;
  scene.frames_per_second = options.frames_per_second;
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;  // what swings about the motion dies away within a swing
  scene.arrival = options.settle ? Arrival::settle : Arrival::pass;
  if (!options.material.empty()) scene.cloth = find_material(options.material)->cloth;
  const std::string source = fmt::format("{} to {}", options.start, target);
  SceneFile file =
      make_scene_file(source, with_meshes(std::move(scene), options.start, target, source));
  OptimizeOptions search;
  search.backend = options.backend;
  search.out = out;
  return optimize(std::move(file), search);
}

}  // namespace nuno
