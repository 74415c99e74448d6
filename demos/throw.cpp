// nuno throw: two meshes or drawings in, a flight out.

#include <fmt/format.h>

#include <filesystem>

#include <nuno/animation.h>
#include <nuno/drawing.h>
#include <nuno/materials.h>
#include <nuno/scene_file.h>
#include "commands.h"
#include "single_rollout.h"

namespace nuno {

namespace {

/// What a throw asks of a scene, whatever the cloth's form.
void ask(const ThrowOptions& options, const std::string& target, Scene& scene) {
  scene.name = std::filesystem::path(target).stem().string();
  scene.arrival_time = options.arrival_time;
  scene.frames_per_second = options.frames_per_second;
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;  // what swings about the motion dies away within a swing
  scene.arrival = options.settle ? Arrival::settle : Arrival::pass;
}

AnyScene scene_of_meshes(const ThrowOptions& options, const std::string& source) {
  std::string target = options.target;
  if (target.empty()) {
    if (!may_have_morph_targets(options.start)) {
      throw InputError(
          "TARGET: is missing; a START of glTF can hold it as a morph target, a drawing as a line");
    }
    target = mesh_file(options.start) + "#";  // its only one
  }
  SheetScene scene;
  ask(options, mesh_file(target), scene);
  if (!options.material.empty()) scene.cloth = find_material(options.material)->cloth;
  return with_meshes(std::move(scene), options.start, target, source);
}

AnyScene scene_of_drawings(const ThrowOptions& options, const std::string& source) {
  if (!options.material.empty()) {
    throw InputError(fmt::format("--material: {} is a cloth of meshes, and {} is a drawn line",
                                 options.material, options.start));
  }
  ChainScene scene;
  if (!options.target.empty()) {
    ask(options, options.target, scene);
    return with_drawings(std::move(scene), options.start, options.target, source);
  }
  ask(options, options.start, scene);
  return with_drawings(std::move(scene), options.start + "#initial", options.start + "#target",
                       source);
}

}  // namespace

ExitStatus throw_cloth(const ThrowOptions& options) {
  const std::string& out = options.out;
  if (!out.empty() && out != "-" && !is_animation(out) && !out.ends_with(".json")) {
    throw InputError(fmt::format("--out: \"{}\" does not end in .json or {}", out,
                                 fmt::join(animation_extensions, ", ")));
  }
  const std::string source = options.target.empty()
                                 ? options.start
                                 : fmt::format("{} to {}", options.start, options.target);
  AnyScene scene = is_drawing(options.start) ? scene_of_drawings(options, source)
                                             : scene_of_meshes(options, source);
  if (options.reverses_target) scene = with_reversed_target(std::move(scene), source);
  SceneFile file = make_scene_file(source, std::move(scene));
  OptimizeOptions search;
  search.backend = options.backend;
  search.out = out;
  search.error_limit = options.error_limit;
  search.changes.reverses_target = options.reverses_target;
  search.animation = options.animation;
  return optimize(std::move(file), search);
}

}  // namespace nuno
