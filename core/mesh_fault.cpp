#include <nuno/mesh_fault.h>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace nuno {
namespace {

using Fault = std::optional<MeshFault>;

/// The least area of a triangle over its longest side squared: below it, it is a line.
constexpr double smallest_relative_area = 1e-6;

class Inspector {
 public:
  Inspector(const Points& vertices, const Faces& faces, Index first_number)
      : x_(vertices), faces_(faces), first_(first_number) {}

  Fault first_fault() const {
    if (faces_.empty()) return MeshFault{MeshFault::At::mesh, 0, "0 faces are not at least one"};
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      std::string what = fault_of_corners(faces_[f]);
      if (what.empty()) what = fault_of_shape(faces_[f]);
      if (!what.empty()) return of_face(f, what);
    }
    if (Fault fault = fault_of_edges()) return fault;
    return fault_of_pieces();
  }

 private:
  Index name(Index vertex) const { return vertex + first_; }

  static MeshFault of_face(std::size_t face, std::string what) {
    return {MeshFault::At::face, static_cast<Index>(face), std::move(what)};
  }

  std::string fault_of_corners(const std::vector<Index>& face) const {
    if (face.size() < 3 || face.size() > 4) {
      return fmt::format("{} corners are not 3 or 4", face.size());
    }
    for (auto corner = face.begin(); corner != face.end(); ++corner) {
      if (*corner < 0 || *corner >= x_.cols()) {
        return fmt::format("vertex {} is not within {} … {}", name(*corner), first_,
                           name(x_.cols() - 1));
      }
      if (std::find(face.begin(), corner, *corner) != corner) {
        return fmt::format("vertex {} stands twice in the face", name(*corner));
      }
    }
    return {};
  }

  /// Edges need a length, and the triangles at every corner an area, all facing the same way.
  std::string fault_of_shape(const std::vector<Index>& face) const {
    const std::size_t n = face.size();
    const auto at = [&](std::size_t i) -> Eigen::Vector3d { return x_.col(face[i % n]); };
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double longest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector3d here = at(i), next = at(i + 1);
      const double length = (next - here).norm();
      if (!(length > smallest_relative_length * here.norm() && length > smallest_scene_number)) {
        return fmt::format("the edge from vertex {} to {} has no length", name(face[i]),
                           name(face[(i + 1) % n]));
      }
      longest = std::max(longest, length);
      normal += (here - at(0)).cross(next - at(0));
    }
    normal.normalize();
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector3d doubled = (at(i + 1) - at(i)).cross(at(i + n - 1) - at(i));
      if (!(0.5 * doubled.norm() >= smallest_relative_area * longest * longest)) {
        return fmt::format("has no area at vertex {}, which lies on a line with its neighbours",
                           name(face[i]));
      }
      if (!(doubled.dot(normal) > 0)) {
        return fmt::format("is a quad that is not convex at vertex {}: two triangles can be",
                           name(face[i]));
      }
    }
    return {};
  }

  Fault fault_of_edges() const {
    std::map<std::pair<Index, Index>, int> beside;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const auto& face = faces_[f];
      for (std::size_t i = 0; i < face.size(); ++i) {
        const auto edge = std::minmax(face[i], face[(i + 1) % face.size()]);
        if (++beside[edge] > 2) {
          return of_face(f, fmt::format("is the third face at the edge from vertex {} to {}; an "
                                        "edge has one or two",
                                        name(edge.first), name(edge.second)));
        }
      }
    }
    return std::nullopt;
  }

  /// Every vertex in a face, and all of them one sheet.
  Fault fault_of_pieces() const {
    std::vector<Index> parent(static_cast<std::size_t>(x_.cols()));
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
    for (const auto& face : faces_) {
      for (const Index i : face) {
        is_used[static_cast<std::size_t>(i)] = true;
        parent[static_cast<std::size_t>(root(i))] = root(face[0]);
      }
    }
    for (Index i = 0; i < x_.cols(); ++i) {
      if (!is_used[static_cast<std::size_t>(i)]) {
        return MeshFault{MeshFault::At::vertex, i, "the vertex is in no face"};
      }
      if (root(i) != root(0)) {
        return MeshFault{MeshFault::At::mesh, 0,
                         fmt::format("are separate sheets, not a single one: nothing holds vertex "
                                     "{} to vertex {}",
                                     name(i), name(0))};
      }
    }
    return std::nullopt;
  }

  const Points& x_;
  const Faces& faces_;
  Index first_;
};

}  // namespace

std::optional<MeshFault> mesh_fault(const Points& vertices, const Faces& faces,
                                    Index first_number) {
  return Inspector(vertices, faces, first_number).first_fault();
}

std::optional<MeshFault> vertex_fault(const Points& vertices) {
  if (vertices.cols() < smallest_particles || vertices.cols() > largest_particles) {
    return MeshFault{MeshFault::At::mesh, 0,
                     fmt::format("{} vertices are not within {} … {}", vertices.cols(),
                                 smallest_particles, largest_particles)};
  }
  for (Index i = 0; i < vertices.cols(); ++i) {
    for (const double value : vertices.col(i)) {
      if (!(std::abs(value) <= largest_scene_number)) {
        return MeshFault{MeshFault::At::vertex, i,
                         fmt::format("{} is not within ±{}", value, largest_scene_number)};
      }
    }
  }
  const Points size = vertices.rowwise().maxCoeff() - vertices.rowwise().minCoeff();
  const double extent = size.norm();
  if (!(extent >= smallest_scene_number &&
        extent >= smallest_relative_length * vertices.cwiseAbs().maxCoeff())) {
    return MeshFault{MeshFault::At::mesh, 0,
                     fmt::format("size {} is not >= {} and {} of its distance from the origin",
                                 extent, smallest_scene_number, smallest_relative_length)};
  }
  return std::nullopt;
}

}  // namespace nuno
