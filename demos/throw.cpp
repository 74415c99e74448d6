// nuno throw: two meshes in, an animated one out.

#include <fmt/format.h>

#include <filesystem>

#include <nuno/animation.h>
#include <nuno/materials.h>
#include <nuno/scene_file.h>
#include "commands.h"
#include "single_rollout.h"

namespace nuno {

ExitStatus throw_cloth(const ThrowOptions& options) {
  const std::string& out = options.out;
  if (!out.empty() && out != "-" && !is_animation(out) && !out.ends_with(".json")) {
    throw InputError(fmt::format("--out: \"{}\" does not end in .json or {}", out,
                                 fmt::join(animation_extensions, ", ")));
  }
  SheetScene scene;
  scene.name = std::filesystem::path(options.target).stem().string();
  scene.arrival_time = options.arrival_time;
  scene.frames_per_second = options.frames_per_second;
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;  // what swings about the motion dies away within a swing
  scene.arrival = options.settle ? Arrival::settle : Arrival::pass;
  if (!options.material.empty()) scene.cloth = find_material(options.material)->cloth;
  const std::string source = fmt::format("{} to {}", options.start, options.target);
  SceneFile file =
      make_scene_file(source, with_meshes(std::move(scene), options.start, options.target, source));
  OptimizeOptions search;
  search.backend = options.backend;
  search.out = out;
  search.animation = options.animation;
  return optimize(std::move(file), search);
}

}  // namespace nuno
