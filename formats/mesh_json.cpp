#include "mesh_json.h"

#include <cmath>

#include "compact_json.h"

namespace nuno {
namespace {

using Json = nlohmann::ordered_json;

Index index(const Json& value, const Field& at, Index count) {
  const double number = value.is_number() ? value.get<double>() : -1;
  if (!(number >= 0 && number < static_cast<double>(count) && number == std::floor(number))) {
    at.refuse(fmt::format("{} is not a whole number within 0 … {}", shown(value), count - 1));
  }
  return static_cast<Index>(number);
}

const Json& list(const Json& value, const Field& at) {
  if (!value.is_array()) at.refuse(fmt::format("{} is not a list", shown(value)));
  return value;
}

std::vector<Index> indices(const Json& value, const Field& at, Index count) {
  std::vector<Index> result;
  for (const Json& item : list(value, at)) {
    result.push_back(index(item, at.child(std::to_string(result.size())), count));
  }
  return result;
}

/// A list of faces, each of the numbers of `count` vertices or texture points.
Faces faces(const Json& value, const Field& at, Index count) {
  Faces result;
  for (const Json& face : list(value, at)) {
    result.push_back(indices(face, at.child(std::to_string(result.size())), count));
  }
  return result;
}

Points points(const Json& scene, const Field& root, const char* name, Index rows) {
  const Field at = root.child(name);
  const Json& value = scene[name];
  Points result;
  if (value.is_binary()) result = points_of(value);
  if (result.rows() != rows) {
    at.refuse(
        fmt::format("{} is not a list of points [x, y{}]", shown(value), rows == 3 ? ", z" : ""));
  }
  return result;
}

void read_texture(const Json& scene, const Field& root, Mesh& mesh) {
  if (!scene.contains("texture_coordinates") || !scene.contains("texture_corners")) return;
  mesh.texture_coordinates = points(scene, root, "texture_coordinates", 2);
  const Field at = root.child("texture_corners");
  mesh.texture_corners = faces(scene["texture_corners"], at, mesh.texture_coordinates.cols());
  if (mesh.texture_corners.size() != mesh.faces.size()) {
    at.refuse(fmt::format("{} faces are not the {} of /faces", mesh.texture_corners.size(),
                          mesh.faces.size()));
  }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.texture_corners[f].size() == mesh.faces[f].size()) continue;
    at.child(std::to_string(f))
        .refuse(fmt::format("{} corners are not the {} of the face", mesh.texture_corners[f].size(),
                            mesh.faces[f].size()));
  }
}

}  // namespace

Points read_vertices(const Json& scene, const Field& root, const char* name) {
  return points(scene, root, name, 3);
}

Mesh read_mesh(const Json& scene, const Field& root) {
  Mesh mesh;
  mesh.vertices = read_vertices(scene, root, "initial");
  mesh.faces = faces(scene["faces"], root.child("faces"), mesh.vertices.cols());
  mesh.texture_coordinates.resize(2, 0);
  read_texture(scene, root, mesh);
  if (scene.contains("file_vertices")) {
    mesh.file_vertices =
        indices(scene["file_vertices"], root.child("file_vertices"), mesh.vertices.cols());
  }
  return mesh;
}

void write_mesh(Json& scene, const Mesh& mesh) {
  scene["faces"] = mesh.faces;
  if (!mesh.texture_corners.empty()) {
    scene["texture_coordinates"] = json_of(mesh.texture_coordinates);
    scene["texture_corners"] = mesh.texture_corners;
  }
  if (!mesh.file_vertices.empty()) scene["file_vertices"] = mesh.file_vertices;
}

}  // namespace nuno
