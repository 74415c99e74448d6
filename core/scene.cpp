#include <nuno/scene.h>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace nuno {
namespace {

constexpr Index smallest_particles = 3;
constexpr Index largest_particles = 1'000'000;

[[noreturn]] void refuse(const std::string& source, std::string_view field,
                         const std::string& what) {
  throw InputError(fmt::format("{}: {}: {}", source, field, what));
}

void require_positive(const std::string& source, std::string_view field, double value) {
  if (!(value > 0)) refuse(source, field, fmt::format("{} is not > 0", value));
  if (!(value >= smallest_scene_number && value <= largest_scene_number)) {
    refuse(source, field,
           fmt::format("{} is not within {} … {}", value, smallest_scene_number,
                       largest_scene_number));
  }
}

void require_not_negative(const std::string& source, std::string_view field, double value) {
  if (!(value >= 0)) refuse(source, field, fmt::format("{} is not >= 0", value));
  if (!(value <= largest_scene_number)) {
    refuse(source, field, fmt::format("{} is not <= {}", value, largest_scene_number));
  }
}

void require_polyline(const std::string& source, std::string_view field, const Points& line) {
  if (line.cols() < 2) {
    refuse(source, field,
           fmt::format("{} point(s) are not at least 2 distinct points", line.cols()));
  }
  for (Index i = 0; i < line.cols(); ++i) {
    for (Index row = 0; row < line.rows(); ++row) {
      const double value = line(row, i);
      if (!(std::abs(value) <= largest_scene_number)) {
        refuse(source, fmt::format("{}/{}/{}", field, i, row),
               fmt::format("{} is not within ±{}", value, largest_scene_number));
      }
    }
  }
  const double length = segment_lengths(line).sum();
  if (!(length > 0)) {
    refuse(source, field, "all points are the same, not at least 2 distinct points");
  }
  if (!(length >= smallest_relative_length * line.cwiseAbs().maxCoeff() &&
        length >= smallest_scene_number)) {
    refuse(source, field,
           fmt::format("length {} is not >= {} and {} of its distance from the origin", length,
                       smallest_scene_number, smallest_relative_length));
  }
}

void require_vertices(const std::string& source, std::string_view field, const Points& points) {
  for (Index i = 0; i < points.cols(); ++i) {
    for (Index row = 0; row < points.rows(); ++row) {
      const double value = points(row, i);
      if (!(std::abs(value) <= largest_scene_number)) {
        refuse(source, fmt::format("{}/{}/{}", field, i, row),
               fmt::format("{} is not within ±{}", value, largest_scene_number));
      }
    }
  }
  const Points size = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  const double extent = size.norm();
  if (!(extent >= smallest_scene_number &&
        extent >= smallest_relative_length * points.cwiseAbs().maxCoeff())) {
    refuse(source, field,
           fmt::format("size {} is not >= {} and {} of its distance from the origin", extent,
                       smallest_scene_number, smallest_relative_length));
  }
}

/// The least area of a triangle over its longest side squared: below it, it is a line.
constexpr double smallest_relative_area = 1e-6;

void require_corners(const std::string& source, const std::string& field,
                     const std::vector<Index>& face, Index vertices) {
  if (face.size() < 3 || face.size() > 4) {
    refuse(source, field, fmt::format("{} corners are not 3 or 4", face.size()));
  }
  for (std::size_t i = 0; i < face.size(); ++i) {
    if (face[i] < 0 || face[i] >= vertices) {
      refuse(source, fmt::format("{}/{}", field, i),
             fmt::format("{} is not within 0 … {}", face[i], vertices - 1));
    }
    if (std::find(face.begin(), face.begin() + static_cast<Index>(i), face[i]) !=
        face.begin() + static_cast<Index>(i)) {
      refuse(source, field, fmt::format("vertex {} stands twice in the face", face[i]));
    }
  }
}

/// Edges that have a length, and triangles that have an area; those of a quad face the same way.
void require_area(const std::string& source, const std::string& field,
                  const std::vector<Index>& face, const Points& x) {
  const std::size_t n = face.size();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double longest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d here = x.col(face[i]), next = x.col(face[(i + 1) % n]);
    const double length = (next - here).norm();
    if (!(length > smallest_relative_length * here.norm() && length > smallest_scene_number)) {
      refuse(
          source, field,
          fmt::format("the edge from vertex {} to {} has no length", face[i], face[(i + 1) % n]));
    }
    longest = std::max(longest, length);
    normal += (here - x.col(face[0])).cross(next - x.col(face[0]));
  }
  normal.normalize();
  for (std::size_t i = 0; i < n; ++i) {  // the triangle at every corner
    const Eigen::Vector3d here = x.col(face[i]);
    const Eigen::Vector3d doubled = (x.col(face[(i + 1) % n]) - here)
                                        .head<3>()
                                        .cross((x.col(face[(i + n - 1) % n]) - here).head<3>());
    if (!(0.5 * doubled.norm() >= smallest_relative_area * longest * longest)) {
      refuse(source, field,
             fmt::format("has no area at vertex {}, which lies on a line with its neighbours",
                         face[i]));
    }
    if (!(doubled.dot(normal) > 0)) {
      refuse(
          source, field,
          fmt::format("is a quad that is not convex at vertex {}: two triangles can be", face[i]));
    }
  }
}

void require_edges_of_two_faces(const std::string& source, const Faces& faces) {
  std::map<std::pair<Index, Index>, int> beside;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& face = faces[f];
    for (std::size_t i = 0; i < face.size(); ++i) {
      const auto edge = std::minmax(face[i], face[(i + 1) % face.size()]);
      if (++beside[edge] > 2) {
        refuse(source, fmt::format("/faces/{}", f),
               fmt::format("is the third face at the edge from vertex {} to {}; an edge has one or "
                           "two",
                           edge.first, edge.second));
      }
    }
  }
}

/// Every vertex in a face, and all of them one sheet.
void require_one_sheet(const std::string& source, const Faces& faces, Index vertices) {
  std::vector<Index> parent(static_cast<std::size_t>(vertices));
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<bool> is_used(parent.size(), false);
  const auto root = [&](Index i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
      auto& up = parent[static_cast<std::size_t>(i)];
      up = parent[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  };
  for (const auto& face : faces) {
    for (const Index i : face) {
      is_used[static_cast<std::size_t>(i)] = true;
      parent[static_cast<std::size_t>(root(i))] = root(face[0]);
    }
  }
  for (Index i = 0; i < vertices; ++i) {
    if (!is_used[static_cast<std::size_t>(i)]) {
      refuse(source, fmt::format("/initial/{}", i), "the vertex is in no face");
    }
    if (root(i) != root(0)) {
      refuse(source, "/faces",
             fmt::format(
                 "are separate sheets, not a single one: nothing holds vertex {} to vertex 0", i));
    }
  }
}

void require_mesh(const std::string& source, const Faces& faces, const Points& initial) {
  if (faces.empty()) refuse(source, "/faces", "0 faces are not at least one");
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::string field = fmt::format("/faces/{}", f);
    require_corners(source, field, faces[f], initial.cols());
    require_area(source, field, faces[f], initial);
  }
  require_edges_of_two_faces(source, faces);
  require_one_sheet(source, faces, initial.cols());
}

/// e^z must stay a number with digits to spare.
void require_drag(const std::string& source, double air_drag, double rate, double arrival_time) {
  const double drag_turns = rate * arrival_time;
  if (!(drag_turns <= 700)) {
    refuse(source, "/cloth/air_drag",
           fmt::format("{} stops the cloth: air_drag/mass·arrival_time = {} is not <= 700",
                       air_drag, drag_turns));
  }
}

void require_timing(const Scene& scene, const std::string& source) {
  require_positive(source, "/arrival_time", scene.arrival_time);
  require_not_negative(source, "/gravity", scene.gravity);
}

void require_choices(const Scene& scene, const std::string& source) {
  if (scene.time_step) require_positive(source, "/time_step", *scene.time_step);
  require_positive(source, "/frames_per_second", scene.frames_per_second);
  require_not_negative(source, "/damping_ratio", scene.damping_ratio);
}

}  // namespace

void validate(const ChainScene& scene, const std::string& source) {
  if (scene.particles < smallest_particles || scene.particles > largest_particles) {
    refuse(source, "/particles",
           fmt::format("{} is not within {} … {}", scene.particles, smallest_particles,
                       largest_particles));
  }
  require_timing(scene, source);
  require_polyline(source, "/initial", scene.initial);
  require_polyline(source, "/target", scene.target);
  require_positive(source, "/cloth/mass", scene.cloth.mass);
  require_not_negative(source, "/cloth/air_drag", scene.cloth.air_drag);
  require_positive(source, "/cloth/stretch_stiffness", scene.cloth.stretch_stiffness);
  require_not_negative(source, "/cloth/stretch_damping", scene.cloth.stretch_damping);
  require_not_negative(source, "/cloth/hinge_stiffness", scene.cloth.hinge_stiffness);
  require_not_negative(source, "/cloth/hinge_damping", scene.cloth.hinge_damping);
  require_choices(scene, source);
  require_drag(source, scene.cloth.air_drag, scene.cloth.air_drag / scene.cloth.mass,
               scene.arrival_time);
}

void validate(const SheetScene& scene, const std::string& source) {
  for (const auto& [field, points] :
       {std::pair{"/initial", &scene.initial}, std::pair{"/target", &scene.target}}) {
    if (points->rows() != 3) {
      refuse(source, field, fmt::format("vertices of {} numbers have not 3", points->rows()));
    }
  }
  if (scene.initial.cols() < smallest_particles || scene.initial.cols() > largest_particles) {
    refuse(source, "/initial",
           fmt::format("{} vertices are not within {} … {}", scene.initial.cols(),
                       smallest_particles, largest_particles));
  }
  if (scene.target.cols() != scene.initial.cols()) {
    refuse(source, "/target",
           fmt::format("{} vertices are not the {} of /initial", scene.target.cols(),
                       scene.initial.cols()));
  }
  require_timing(scene, source);
  require_vertices(source, "/initial", scene.initial);
  require_vertices(source, "/target", scene.target);
  require_mesh(source, scene.faces, scene.initial);
  require_positive(source, "/cloth/areal_density", scene.cloth.areal_density);
  require_not_negative(source, "/cloth/air_drag", scene.cloth.air_drag);
  require_positive(source, "/cloth/stretch_stiffness", scene.cloth.stretch_stiffness);
  require_not_negative(source, "/cloth/stretch_damping", scene.cloth.stretch_damping);
  require_not_negative(source, "/cloth/shear_stiffness", scene.cloth.shear_stiffness);
  require_not_negative(source, "/cloth/shear_damping", scene.cloth.shear_damping);
  require_not_negative(source, "/cloth/bending_stiffness", scene.cloth.bending_stiffness);
  require_not_negative(source, "/cloth/bending_damping", scene.cloth.bending_damping);
  require_choices(scene, source);
  require_drag(source, scene.cloth.air_drag, scene.cloth.air_drag / scene.cloth.areal_density,
               scene.arrival_time);
}

}  // namespace nuno
