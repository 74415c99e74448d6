#include <nuno/mesh.h>

#include <nuno/mesh_fault.h>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <string_view>

#include "text_file.h"

namespace nuno {
namespace {

constexpr std::size_t most_corners = 1000;  // of a face

struct Corner {
  Index vertex = 0;
  std::optional<Index> texture;
};

Corner corner(std::string_view word, Index vertices, Index textures, const Line& line) {
  std::array<std::string_view, 3> parts;  // v, vt, vn
  std::size_t count = 0;
  for (std::size_t start = 0; start <= word.size(); ++count) {
    if (count == parts.size()) line.refuse(word, "is not a corner: v, v/vt, v//vn or v/vt/vn");
    const std::size_t end = std::min(word.find('/', start), word.size());
    parts[count] = word.substr(start, end - start);
    start = end + 1;
  }
  Corner result{obj_index(parts[0], word, vertices, "vertex", line), {}};
  if (!parts[1].empty())
    result.texture = obj_index(parts[1], word, textures, "texture point", line);
  return result;
}

/// Collects a file's elements.
struct Reader {
  std::vector<double> vertices, textures;
  Mesh mesh;
  bool all_textured = true;

  Index vertex_count() const { return static_cast<Index>(vertices.size() / 3); }
  Index texture_count() const { return static_cast<Index>(textures.size() / 2); }

  static void read_numbers(std::string_view statement, std::string_view rest, std::size_t count,
                           const Line& line, std::vector<double>& into) {
    const std::string_view all = rest;
    for (std::size_t k = 0; k < count; ++k) {
      const std::string_view word = next_word(rest);
      if (word.empty()) {
        line.refuse(all.empty() ? statement : all, fmt::format("has not {} numbers", count));
      }
      into.push_back(number(word, line));
    }
  }

  void read_face(std::string_view rest, const Line& line) {
    const std::string_view all = rest;
    std::vector<Corner> corners;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      corners.push_back(corner(word, vertex_count(), texture_count(), line));
      if (corners.size() > most_corners) {
        line.refuse(all, fmt::format("has more than {} corners", most_corners));
      }
    }
    if (corners.size() < 3) line.refuse(all.empty() ? "f" : all, "has fewer than 3 corners");
    std::vector<Index>& face = mesh.faces.emplace_back();
    std::vector<Index>& texture = mesh.texture_corners.emplace_back();
    for (const Corner& each : corners) {
      if (std::ranges::find(face, each.vertex) != face.end()) {
        line.refuse(all, fmt::format("has vertex {} twice", each.vertex + 1));
      }
      face.push_back(each.vertex);
      texture.push_back(each.texture.value_or(0));
      all_textured = all_textured && each.texture;
    }
    mesh.lines.push_back(line.number);
  }

  void read_line(std::string_view rest, const Line& line) {
    const std::string_view word = next_word(rest);
    static constexpr std::array<std::string_view, 24> passed_over = {
        "vn",     "vp",     "g",      "o",     "s",        "usemtl",   "mtllib",     "l",
        "p",      "lod",    "mg",     "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj",
        "usemap", "maplib", "cstype", "deg",   "end",      "parm",     "curv",       "surf"};
    if (word == "v") {
      read_numbers(word, rest, 3, line, vertices);
      mesh.vertex_lines.push_back(line.number);
    } else if (word == "vt") {
      read_numbers(word, rest, 2, line, textures);
    } else if (word == "f" || word == "fo") {
      read_face(rest, line);
    } else if (!word.empty() && std::ranges::find(passed_over, word) == passed_over.end()) {
      line.refuse(word, "is not a statement of a Wavefront OBJ file");
    }
  }
};

}  // namespace

Mesh parse_obj(const std::string& text, const std::string& source) {
  Reader reader;
  for_each_obj_line(text, source, [&](std::string_view words, const Line& line) {
    reader.read_line(words, line);
  });
  Mesh mesh = std::move(reader.mesh);
  if (mesh.faces.empty())
    throw InputError(fmt::format("{}: has no face (f); a mesh is required", source));
  mesh.vertices = Eigen::Map<const Points>(reader.vertices.data(), 3, reader.vertex_count());
  mesh.first_number = 1;
  if (reader.all_textured) {
    mesh.texture_coordinates =
        Eigen::Map<const Points>(reader.textures.data(), 2, reader.texture_count());
  } else {
    mesh.texture_corners.clear();
  }
  return mesh;
}

std::vector<std::array<Index, 3>> triangulated(const Points& polygon) {
  const Index count = polygon.cols();
  const auto at = [&](Index i) -> Eigen::Vector3d { return polygon.col(i) - polygon.col(0); };
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (Index i = 0; i < count; ++i) normal += at(i).cross(at((i + 1) % count));
  const auto turn = [&](Index a, Index b, Index c) {
    return normal.dot((at(b) - at(a)).cross(at(c) - at(b)));
  };
  std::vector<Index> left(static_cast<std::size_t>(count));
  std::iota(left.begin(), left.end(), Index{0});
  const auto corners_at = [&](std::size_t place) {
    const std::size_t n = left.size();
    return std::array{left[(place + n - 1) % n], left[place], left[(place + 1) % n]};
  };
  const auto is_ear = [&](std::size_t place) {
    const auto [a, b, c] = corners_at(place);
    if (!(turn(a, b, c) > 0)) return false;
    return std::ranges::none_of(left, [&, a = a, b = b, c = c](Index p) {
      return p != a && p != b && p != c && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 &&
             turn(c, a, p) >= 0;
    });
  };
  std::vector<std::array<Index, 3>> triangles;
  while (left.size() > 3) {
    std::size_t ear = 0;
    while (ear < left.size() && !is_ear(ear)) ++ear;
    if (ear == left.size()) ear = 1;  // not a simple polygon: any cut is as good
    triangles.push_back(corners_at(ear));
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

void cut_polygons(Mesh& mesh) {
  Mesh cut = mesh;
  cut.faces.clear();
  cut.texture_corners.clear();
  cut.lines.clear();
  const bool textured = !mesh.texture_corners.empty();
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const std::vector<Index>& face = mesh.faces[f];
    const auto add = [&](auto corners_of) {
      cut.faces.push_back(corners_of(face));
      if (textured) cut.texture_corners.push_back(corners_of(mesh.texture_corners[f]));
      if (!mesh.lines.empty()) cut.lines.push_back(mesh.lines[f]);
    };
    if (face.size() <= 4) {
      add([](const std::vector<Index>& corners) { return corners; });
      continue;
    }
    for (const auto& places : triangulated(mesh.vertices(Eigen::all, face))) {
      add([&](const std::vector<Index>& corners) {
        std::vector<Index> three;
        three.reserve(places.size());
        for (const Index place : places) three.push_back(corners[static_cast<std::size_t>(place)]);
        return three;
      });
    }
  }
  mesh = std::move(cut);
}

std::string face_place(const Mesh& mesh, const std::string& path, std::size_t face) {
  return mesh.lines.empty() ? fmt::format("{}: face {}", path, face)
                            : fmt::format("{}:{}", path, mesh.lines[face]);
}

std::string numbers_in_file(const Mesh& mesh, std::vector<Index> face) {
  for (Index& vertex : face) {
    if (!mesh.file_vertices.empty()) {  // its first copy's
      vertex = std::ranges::find(mesh.file_vertices, vertex) - mesh.file_vertices.begin();
    }
    vertex += mesh.first_number;
  }
  return fmt::format("{}", fmt::join(face, " "));
}

namespace {

[[noreturn]] void refuse(const Mesh& mesh, const std::string& path, const MeshFault& fault) {
  const auto number = static_cast<std::size_t>(fault.number);
  switch (fault.at) {
    case MeshFault::At::mesh:
      break;
    case MeshFault::At::face:
      throw InputError(fmt::format("{}: face {}: {}", face_place(mesh, path, number),
                                   numbers_in_file(mesh, mesh.faces[number]), fault.what));
    case MeshFault::At::vertex:
      throw InputError(fmt::format(
          "{}{}: vertex {}: {}", path,
          mesh.vertex_lines.empty() ? "" : fmt::format(":{}", mesh.vertex_lines[number]),
          numbers_in_file(mesh, {fault.number}), fault.what));
  }
  throw InputError(fmt::format("{}: {}", path, fault.what));
}

}  // namespace

void require_sheet(const Mesh& mesh, const std::string& path) {
  require_pose(mesh, path);
  if (const auto fault = mesh_fault(mesh.vertices, mesh.faces, mesh.first_number)) {
    refuse(mesh, path, *fault);
  }
}

void require_pose(const Mesh& pose, const std::string& path) {
  if (const auto fault = vertex_fault(pose.vertices)) refuse(pose, path, *fault);
}

void require_same_faces(const Mesh& mesh, const std::string& path, const Mesh& pose,
                        const std::string& pose_path) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(
        fmt::format("{}: {} as {}: it is no pose of the same mesh", pose_path, what, path));
  };
  const auto count = [](const Faces& faces) { return faces.size(); };
  if (pose.vertices.cols() != mesh.vertices.cols()) {
    refuse(
        fmt::format("{} vertices are not {}, as many", pose.vertices.cols(), mesh.vertices.cols()));
  }
  if (count(pose.faces) != count(mesh.faces)) {
    refuse(fmt::format("{} faces are not {}, as many", pose.faces.size(), mesh.faces.size()));
  }
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const auto& face = mesh.faces[i];
    if (std::ranges::equal(pose.faces[i], face) ||
        std::equal(pose.faces[i].rbegin(), pose.faces[i].rend(), face.begin(), face.end())) {
      continue;
    }
    throw InputError(fmt::format(
        "{}: the face {} is {} in {}: the vertices stand in another order, or it is no pose of "
        "the same mesh; export both with the order of vertices kept",
        face_place(pose, pose_path, i), numbers_in_file(pose, pose.faces[i]),
        numbers_in_file(mesh, mesh.faces[i]), path));
  }
}

}  // namespace nuno
