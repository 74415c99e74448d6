// A scene and its shapes: points, or meshes that are made a sheet.

#include <nuno/scene_file.h>

#include <algorithm>
#include <utility>

namespace nuno {

const Scene& scene_of(const AnyScene& scene) {
  if (const auto* chain = std::get_if<ChainScene>(&scene)) return *chain;
  return std::get<SheetInput>(scene).scene;
}

ChainScene with_shapes(ChainScene scene, const Shapes& shapes, const std::string& source) {
  scene.initial = shapes.initial;
  scene.target = shapes.target;
  validate(scene, source);
  return scene;
}

SheetInput with_shapes(SheetScene scene, const Shapes& shapes, const std::string& source) {
  scene.initial = shapes.initial;
  scene.target = shapes.target;
  scene.faces = shapes.faces;
  validate(scene, source);
  Mesh mesh;
  mesh.vertices = shapes.initial;
  mesh.faces = shapes.faces;
  return {std::move(scene), std::move(mesh)};
}

SheetInput with_meshes(SheetScene scene, const std::string& initial, const std::string& target,
                       const std::string& source) {
  Mesh start = read_mesh(initial);  // first, so that its faults are told first
  return with_meshes(std::move(scene), initial, std::move(start), target, read_mesh(target),
                     source);
}

SheetInput with_meshes(SheetScene scene, const std::string& initial, Mesh start,
                       const std::string& target, Mesh end, const std::string& source) {
  weld_seams(start, end);
  require_same_faces(start, initial, end, target);
  cut_polygons(start);
  require_sheet(start, initial);
  require_pose(end, target);
  for (const std::string& remark : end.remarks) {
    if (std::ranges::find(start.remarks, remark) == start.remarks.end()) {
      start.remarks.push_back(remark);
    }
  }
  scene.initial = start.vertices;
  scene.target = end.vertices;
  scene.faces = start.faces;
  validate(scene, source);
  return {std::move(scene), std::move(start)};
}

}  // namespace nuno
