#include <nuno/throw_scene.h>

#include <fmt/format.h>

#include <nuno/drawing.h>
#include <nuno/materials.h>

#include <filesystem>
#include <utility>

namespace nuno {
namespace {

/// What a throw asks of a scene, whatever the cloth's form.
void ask(const ThrowRequest& request, Scene& scene) {
  scene.arrival_time = request.arrival_time;
  scene.frames_per_second = request.frames_per_second;
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;  // what swings about the motion dies away within a swing
  scene.arrival = request.settle ? Arrival::settle : Arrival::pass;
}

void require_material(const ThrowRequest& request) {
  if (request.material.empty() || find_material(request.material)) return;
  throw InputError(
      fmt::format("--material: \"{}\" is not one of {}", request.material, material_names()));
}

std::string name_of_file(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

SheetScene sheet_scene(const ThrowRequest& request) {
  SheetScene scene;
  ask(request, scene);
  if (!request.material.empty()) scene.cloth = find_material(request.material)->cloth;
  return scene;
}

ChainScene chain_scene(const ThrowRequest& request, const std::string& what) {
  if (!request.material.empty()) {
    throw InputError(fmt::format("--material: {} is a cloth of meshes, and {} is a drawn line",
                                 request.material, what));
  }
  ChainScene scene;
  ask(request, scene);
  return scene;
}

AnyScene scene_of_meshes(const ThrowRequest& request, const std::string& start, std::string target,
                         const std::string& source) {
  if (target.empty()) {
    if (!may_have_morph_targets(start)) {
      throw InputError(
          "TARGET: is missing; a START of glTF can hold it as a morph target, a drawing as a line");
    }
    target = mesh_file(start) + "#";  // its only one
  }
  SheetScene scene = sheet_scene(request);
  scene.name = name_of_file(mesh_file(target));
  return with_meshes(std::move(scene), start, target, source);
}

AnyScene scene_of_drawings(const ThrowRequest& request, const std::string& start,
                           const std::string& target, const std::string& source) {
  ChainScene scene = chain_scene(request, start);
  if (!target.empty()) {
    scene.name = name_of_file(target);
    return with_drawings(std::move(scene), start, target, source);
  }
  scene.name = name_of_file(start);
  return with_drawings(std::move(scene), start + "#initial", start + "#target", source);
}

}  // namespace

std::string throw_source(const std::string& start, const std::string& target) {
  return target.empty() ? start : fmt::format("{} to {}", start, target);
}

AnyScene throw_scene(const ThrowRequest& request, const std::string& start,
                     const std::string& target) {
  require_material(request);
  const std::string source = throw_source(start, target);
  return is_drawing(start) ? scene_of_drawings(request, start, target, source)
                           : scene_of_meshes(request, start, target, source);
}

AnyScene throw_scene(const ThrowRequest& request, const Shapes& shapes, const std::string& source) {
  require_material(request);
  if (shapes.faces.empty()) return with_shapes(chain_scene(request, source), shapes, source);
  return with_shapes(sheet_scene(request), shapes, source);
}

}  // namespace nuno
