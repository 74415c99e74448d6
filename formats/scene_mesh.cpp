#include "scene_mesh.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "compact_json.h"

namespace nuno {
namespace {

using Json = nlohmann::ordered_json;

Points points_in(const Json& mesh, const Field& at, const char* name, Index rows) {
  const Field field = at.child(name);
  if (!mesh.contains(name)) field.refuse("is missing; it is required");
  const Json& value = mesh[name];
  if (!value.is_binary()) field.refuse(fmt::format("{} is not a list of points", shown(value)));
  Points points = points_of(value);
  if (points.rows() != rows) {
    field.child("0").refuse(fmt::format("{} numbers are not {}", points.rows(), rows));
  }
  return points;
}

/// Whole numbers within 0 … `end` − 1.
std::vector<Index> numbers_in(const Json& list, const Field& at, Index end) {
  if (!list.is_array()) at.refuse(fmt::format("{} is not a list", shown(list)));
  std::vector<Index> numbers;
  for (const Json& each : list) {
    const double number = each.is_number() ? each.get<double>() : -1;
    if (!(number >= 0 && number < static_cast<double>(end) && number == std::floor(number))) {
      at.refuse(fmt::format("{} is not a whole number within 0 … {}", shown(each), end - 1));
    }
    numbers.push_back(static_cast<Index>(number));
  }
  return numbers;
}

Faces faces_in(const Json& mesh, const Field& at, const char* name, Index end) {
  const Field field = at.child(name);
  if (!mesh.contains(name)) field.refuse("is missing; it is required");
  if (!mesh[name].is_array()) {
    field.refuse(fmt::format("{} is not a list of faces", shown(mesh[name])));
  }
  Faces faces;
  for (const Json& face : mesh[name]) {
    faces.push_back(numbers_in(face, field.child(std::to_string(faces.size())), end));
  }
  return faces;
}

void read_texture(const Json& value, const Field& at, Mesh& mesh) {
  mesh.texture_coordinates = points_in(value, at, "texture_coordinates", 2);
  mesh.texture_corners = faces_in(value, at, "texture_corners", mesh.texture_coordinates.cols());
  const bool fits = std::ranges::equal(
      mesh.faces, mesh.texture_corners,
      [](const auto& face, const auto& corners) { return face.size() == corners.size(); });
  if (!fits) at.child("texture_corners").refuse("has not the corners of /faces");
}

}  // namespace

Mesh mesh_in_scene(const Json& value, const Field& at, bool is_pose) {
  if (!value.is_object()) at.refuse(fmt::format("{} is not a mesh", shown(value)));
  const std::vector<std::string_view> known =
      is_pose ? std::vector<std::string_view>{"vertices"}
              : std::vector<std::string_view>{"vertices", "faces", "texture_coordinates",
                                              "texture_corners", "file_vertices"};
  for (const auto& item : value.items()) {
    if (std::ranges::find(known, item.key()) == known.end()) {
      at.refuse(
          fmt::format("{} is not one of {}", shown(Json(item.key())), fmt::join(known, ", ")));
    }
  }
  Mesh mesh;
  mesh.vertices = points_in(value, at, "vertices", 3);
  if (is_pose) return mesh;
  const Index count = mesh.vertices.cols();
  mesh.faces = faces_in(value, at, "faces", count);
  if (value.contains("texture_coordinates")) read_texture(value, at, mesh);
  if (value.contains("file_vertices")) {
    mesh.file_vertices = numbers_in(value["file_vertices"], at.child("file_vertices"), count);
  }
  return mesh;
}

Json json_of(const Mesh& mesh) {
  Json value = {{"vertices", json_of(mesh.vertices)}, {"faces", mesh.faces}};
  if (!mesh.texture_corners.empty()) {
    value["texture_coordinates"] = json_of(mesh.texture_coordinates);
    value["texture_corners"] = mesh.texture_corners;
  }
  if (!mesh.file_vertices.empty()) value["file_vertices"] = mesh.file_vertices;
  return value;
}

}  // namespace nuno
