#include <nuno/mesh.h>

#include <nuno/mesh_fault.h>
#include <nuno/output.h>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>
#include <string_view>

namespace nuno {
namespace {

constexpr std::uintmax_t largest_file = 256 << 20;  // bytes: millions of vertices
constexpr std::size_t most_corners = 1000;          // of a face

/// A place of the file, for messages.
struct Line {
  const std::string& source;
  Index number = 0;

  [[noreturn]] void refuse(std::string_view value, const std::string& rule) const {
    value.remove_prefix(std::min(value.find_first_not_of(" \t"), value.size()));
    const std::string text = printable(std::string(value.substr(0, 60)));
    throw InputError(fmt::format("{}:{}: {} {}", source, number, text, rule));
  }
};

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // of UTF-8
constexpr std::string_view blanks = " \t\r\v\f";

/// Cuts the next word off `rest`; empty at its end.
std::string_view next_word(std::string_view& rest) {
  const std::size_t start = std::min(rest.find_first_not_of(blanks), rest.size());
  const std::size_t end = std::min(rest.find_first_of(blanks, start), rest.size());
  const std::string_view word = rest.substr(start, end - start);
  rest.remove_prefix(end);
  return word;
}

double number(std::string_view word, const Line& line) {
  std::string_view digits = word;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_number = end == digits.data() + digits.size() && !word.starts_with("+-");
  if (is_number && error == std::errc::result_out_of_range) {
    value = std::strtod(std::string(digits).c_str(), nullptr);  // 0 or infinity
  } else if (!is_number || error != std::errc() || std::isnan(value)) {
    line.refuse(word, "is not a number");
  }
  if (!(std::abs(value) <= largest_scene_number)) {
    line.refuse(word, fmt::format("is not within ±{}", largest_scene_number));
  }
  return value;
}

/// An index of the file, from 1 on or from the back, as one from 0 on.
Index index(std::string_view text, std::string_view word, Index count, const char* of,
            const Line& line) {
  Index value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    line.refuse(word, "is not a corner: v, v/vt, v//vn or v/vt/vn");
  }
  const Index from_front = value > 0 ? value - 1 : count + value;
  if (value == 0 || from_front < 0 || from_front >= count) {
    line.refuse(word, fmt::format("names a {} that is not among the {} above", of, count));
  }
  return from_front;
}

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
  Corner result{index(parts[0], word, vertices, "vertex", line), {}};
  if (!parts[1].empty()) result.texture = index(parts[1], word, textures, "texture point", line);
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
    rest = rest.substr(0, rest.find('#'));
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
  Line line{source};
  std::string joined;  // of lines that end in a backslash
  Index next_line = 1;
  for (std::size_t start = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
       start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string_view raw(text.data() + start, end - start);
    start = end + 1;
    if (joined.empty()) line.number = next_line;
    ++next_line;
    while (raw.ends_with('\r')) raw.remove_suffix(1);
    if (raw.ends_with('\\')) {
      raw.remove_suffix(1);
      joined.append(raw).append(" ");
      continue;
    }
    if (joined.empty()) {
      reader.read_line(raw, line);
    } else {
      reader.read_line(joined.append(raw), line);
      joined.clear();
    }
  }
  if (!joined.empty()) reader.read_line(joined, line);
  Mesh mesh = std::move(reader.mesh);
  if (mesh.faces.empty())
    throw InputError(fmt::format("{}: has no face (f); a mesh is required", source));
  mesh.vertices = Eigen::Map<const Points>(reader.vertices.data(), 3, reader.vertex_count());
  if (reader.all_textured) {
    mesh.texture_coordinates =
        Eigen::Map<const Points>(reader.textures.data(), 2, reader.texture_count());
  } else {
    mesh.texture_corners.clear();
  }
  return mesh;
}

Mesh read_mesh(const std::string& path) {
  std::error_code error;
  if (!path.ends_with(".obj") && !path.ends_with(".OBJ")) {
    throw InputError(fmt::format("{}: does not end in .obj", path));
  }
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(fmt::format("{}: is a directory, not a mesh", path));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: cannot be opened for reading", path));
  std::string text;
  std::vector<char> block(1 << 16);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(file.gcount()));
    if (text.size() > largest_file) {
      throw InputError(fmt::format("{}: is larger than {} MiB", path, largest_file >> 20));
    }
  }
  if (file.bad()) throw InputError(fmt::format("{}: cannot be read", path));
  return parse_obj(text, path);
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
  Mesh cut{mesh.vertices, {}, mesh.texture_coordinates, {}, {}, mesh.vertex_lines};
  const bool textured = !mesh.texture_corners.empty();
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const std::vector<Index>& face = mesh.faces[f];
    const auto add = [&](auto corners_of) {
      cut.faces.push_back(corners_of(face));
      if (textured) cut.texture_corners.push_back(corners_of(mesh.texture_corners[f]));
      cut.lines.push_back(mesh.lines[f]);
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

namespace {

[[noreturn]] void refuse(const Mesh& mesh, const std::string& path, const MeshFault& fault) {
  const auto number = static_cast<std::size_t>(fault.number);
  switch (fault.at) {
    case MeshFault::At::mesh:
      break;
    case MeshFault::At::face: {
      std::vector<Index> face = mesh.faces[number];
      for (Index& vertex : face) ++vertex;  // OBJ counts from 1
      throw InputError(fmt::format("{}:{}: face {}: {}", path, mesh.lines[number],
                                   fmt::join(face, " "), fault.what));
    }
    case MeshFault::At::vertex:
      throw InputError(fmt::format("{}:{}: vertex {}: {}", path, mesh.vertex_lines[number],
                                   fault.number + 1, fault.what));
  }
  throw InputError(fmt::format("{}: {}", path, fault.what));
}

}  // namespace

void require_sheet(const Mesh& mesh, const std::string& path) {
  require_pose(mesh, path);
  if (const auto fault = mesh_fault(mesh.vertices, mesh.faces, 1)) refuse(mesh, path, *fault);
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
    if (pose.faces[i] == mesh.faces[i]) continue;
    const auto from_one = [](std::vector<Index> face) {
      for (Index& vertex : face) ++vertex;
      return fmt::format("{}", fmt::join(face, " "));
    };
    throw InputError(fmt::format(
        "{}:{}: the face {} is {} in {}: the vertices stand in another order, or it is no pose of "
        "the same mesh; export both with the order of vertices kept",
        pose_path, pose.lines[i], from_one(pose.faces[i]), from_one(mesh.faces[i]), path));
  }
}

}  // namespace nuno
