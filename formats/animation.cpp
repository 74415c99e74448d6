#include <nuno/animation.h>

#include <nuno/glb_file.h>
#include <nuno/output.h>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <utility>

#include "animation_files.h"

namespace nuno {
namespace {

/// The first run of # in a path's file name: where it starts, and its length; 0 if there is none.
std::pair<std::size_t, std::size_t> number_place(const std::string& path) {
  const std::size_t name = path.find_last_of('/') + 1;  // npos + 1 is 0
  const std::size_t start = path.find('#', name);
  if (start == std::string::npos) return {0, 0};
  const std::size_t end = std::min(path.find_first_not_of('#', start), path.size());
  return {start, end - start};
}

std::string numbered(const std::string& path, Index number) {
  const auto [start, length] = number_place(path);
  return std::string(path).replace(start, length, fmt::format("{:0{}}", number, length));
}

/// Packages count in whole frames; glTF and USD tell a frame's own time.
bool counts_frames(std::string_view path) {
  return !path.ends_with(".glb") && !path.ends_with(".usda");
}

/// The frames with a vertex for each of the mesh's file, copies at seams included.
Animation in_file_order(Animation animation) {
  const std::vector<Index>& vertices = animation.mesh.file_vertices;
  if (vertices.empty()) return animation;
  for (Points& shape : animation.positions) shape = shape(Eigen::all, vertices).eval();
  return animation;
}

}  // namespace

bool is_animation(std::string_view path) {
  return std::ranges::any_of(animation_extensions,
                             [&](std::string_view end) { return path.ends_with(end); });
}

void require_animation(const std::string& path, double arrival_time, double frames_per_second) {
  const double frames = arrival_time * frames_per_second;
  const double whole = std::max(1.0, std::round(frames));
  if (counts_frames(path) && std::abs(frames - whole) > 1e-6 * whole) {
    throw InputError(fmt::format(
        "--out: {}: counts in whole frames, and {} s are {:.6g} frames at {} per second; arrive at "
        "{:.10g} s",
        path, arrival_time, frames, frames_per_second, whole / frames_per_second));
  }
  if (path.ends_with(".obj") && number_place(path).second == 0) {
    throw InputError(fmt::format(
        "--out: {}: has no # in its name, where the number of each frame goes: flight-####.obj",
        path));
  }
}

void write_animation(std::FILE* file, std::string_view extension, const Animation& animation) {
  if (extension == ".glb") {
    write_glb(file, animation.name, animation.mesh, animation.times, animation.positions);
  } else if (extension == ".usda") {
    write_usda(file, animation);
  } else {
    assert(extension == ".pc2" || extension == ".mdd");
    (extension == ".pc2" ? write_pc2 : write_mdd)(file, in_file_order(animation));
  }
}

void write_animation(const std::string& path, const Animation& animation) {
  const auto extension = std::ranges::find_if(
      animation_extensions, [&](std::string_view end) { return path.ends_with(end); });
  assert(extension != animation_extensions.end());
  if (*extension != ".obj") {
    write_output(path, [&](std::FILE* file) { write_animation(file, *extension, animation); });
  } else {
    for (std::size_t k = 0; k < animation.positions.size(); ++k) {
      write_output(numbered(path, animation.first_frame + static_cast<Index>(k)),
                   [&](std::FILE* file) {
                     write_obj(file, animation.name, animation.mesh, animation.positions[k]);
                   });
    }
  }
}

Points ribbon(const Points& shape, double width) {
  const Index count = shape.cols();
  Points vertices(3, 2 * count);
  vertices.topRows(2) << shape, shape;
  vertices.row(2).head(count).setConstant(-width / 2);
  vertices.row(2).tail(count).setConstant(width / 2);
  return vertices;
}

Mesh ribbon_mesh(const Points& shape, double width) {
  const Index count = shape.cols();
  Mesh mesh;
  mesh.vertices = ribbon(shape, width);
  mesh.texture_coordinates.resize(2, 2 * count);
  for (Index i = 0; i < count; ++i) {
    const double along = static_cast<double>(i) / static_cast<double>(count - 1);
    mesh.texture_coordinates.col(i) << along, 0;
    mesh.texture_coordinates.col(count + i) << along, 1;
  }
  for (Index i = 0; i + 1 < count; ++i) {
    mesh.faces.push_back({i, i + 1, count + i + 1, count + i});
    mesh.lines.push_back(0);
  }
  mesh.texture_corners = mesh.faces;
  return mesh;
}

}  // namespace nuno
