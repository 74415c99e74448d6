#include <nuno/mesh.h>

#include <nuno/output.h>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <tuple>

#include "compact_json.h"
#include "gltf_document.h"
#include "text_file.h"

namespace nuno {
namespace {

constexpr Index triangle_list = 4, triangle_strip = 5, triangle_fan = 6;  // modes of primitives

/// What a file must be read with, all of it that bears on shapes, is known here.
void require_known_extensions(const GltfItem& root) {
  if (!root.has("extensionsRequired")) return;
  const GltfItem all = root.child("extensionsRequired");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string& name = all.child(i).text();
    // Positions as integers are read; how a surface looks is passed over.
    constexpr std::array known = {"KHR_mesh_quantization", "KHR_materials_", "KHR_texture_",
                                  "EXT_texture_", "KHR_lights_"};
    if (std::ranges::none_of(known, [&](const char* each) { return name.starts_with(each); })) {
      all.child(i).at.refuse(
          fmt::format("{} is not read: export without it", shown(all.child(i).value)));
    }
  }
}

// Nodes

Eigen::Affine3d transform_of(const GltfItem& node) {
  const auto numbers = [&](const char* name, std::size_t count, Eigen::VectorXd otherwise) {
    if (!node.has(name)) return otherwise;
    const GltfItem all = node.child(name);
    if (all.size() != count) {
      all.at.refuse(fmt::format("{} numbers are not {}", all.size(), count));
    }
    for (std::size_t i = 0; i < count; ++i)
      otherwise[static_cast<Index>(i)] = all.child(i).number();
    return otherwise;
  };
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (node.has("matrix")) {
    const Eigen::VectorXd columns = numbers("matrix", 16, Eigen::VectorXd(16));
    transform.matrix() = columns.reshaped(4, 4);
    if (!transform.matrix().row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-6)) {
      node.child("matrix").at.refuse("has not 0, 0, 0, 1 as its fourth row");
    }
    return transform;
  }
  const Eigen::Vector3d scale = numbers("scale", 3, Eigen::Vector3d::Ones());
  const Eigen::Vector3d translation = numbers("translation", 3, Eigen::Vector3d::Zero());
  const Eigen::Vector4d rotation = numbers("rotation", 4, Eigen::Vector4d::UnitW());
  if (!(std::abs(rotation.norm() - 1) < 1e-3)) {
    node.child("rotation").at.refuse(fmt::format("length {} is not 1", rotation.norm()));
  }
  const Eigen::Quaterniond turn(rotation.normalized());  // x, y, z, w
  transform.translate(translation).rotate(turn).scale(scale);
  return transform;
}

/// Of each node, the one whose child it is; −1 of roots.
std::vector<Index> parents(const GltfItem& nodes) {
  std::vector<Index> parent(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes.child(i).has("children")) continue;
    const GltfItem children = nodes.child(i).child("children");
    for (std::size_t k = 0; k < children.size(); ++k) {
      const Index child = children.child(k).whole(0, static_cast<Index>(nodes.size()) - 1);
      Index& above = parent[static_cast<std::size_t>(child)];
      if (above >= 0) {
        children.child(k).at.refuse(fmt::format("{} is a child of node {} already", child, above));
      }
      above = static_cast<Index>(i);
    }
  }
  return parent;
}

/// From the first mesh to the world, by the first node that has it; nothing where none has.
Eigen::Affine3d world_transform(const GltfItem& root) {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (!root.has("nodes")) return transform;
  const GltfItem nodes = root.child("nodes");
  const auto most = static_cast<Index>(root.child("meshes").size()) - 1;
  std::size_t first = 0;
  while (first < nodes.size() && nodes.child(first).whole("mesh", -1, 0, most) != 0) ++first;
  if (first == nodes.size()) return transform;
  if (nodes.child(first).has("skin")) {
    nodes.child(first).child("skin").at.refuse(
        "bones pose the mesh, and are not read: apply them to it before the export");
  }
  const std::vector<Index> parent = parents(nodes);
  std::size_t steps = 0;
  for (auto i = static_cast<Index>(first); i >= 0; i = parent[static_cast<std::size_t>(i)]) {
    const GltfItem node = nodes.child(static_cast<std::size_t>(i));
    if (++steps > nodes.size()) node.at.refuse("is a node below itself");
    transform = transform_of(node) * transform;
  }
  return transform;
}

// Morph targets

std::vector<std::string> target_names(const GltfItem& mesh, std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back(std::to_string(i));
  if (!mesh.has("extras") || !mesh.value["extras"].is_object()) return names;
  const auto& extras = mesh.value["extras"];
  if (!extras.contains("targetNames") || !extras["targetNames"].is_array()) return names;
  const auto& given = extras["targetNames"];
  for (std::size_t i = 0; i < std::min(count, given.size()); ++i) {
    if (given[i].is_string()) names[i] = given[i].get<std::string>();
  }
  return names;
}

/// The number of the morph target of this name; an empty name is the only one's.
std::size_t find_target(const GltfItem& mesh, const std::string& name) {
  const GltfItem primitive = mesh.child("primitives").child(std::size_t{0});
  const std::size_t count = primitive.has("targets") ? primitive.child("targets").size() : 0;
  if (count == 0) mesh.at.refuse("has no morph target (shape key) to be thrown to");
  const std::vector<std::string> names = target_names(mesh, count);
  if (name.empty() && count == 1) return 0;
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    constexpr std::size_t most = 200;
    std::string known = printable(fmt::format("{}", fmt::join(names, ", ")));
    if (known.size() > most) known = shown_text(known, most - 3) + "...";
    mesh.at.refuse(
        name.empty()
            ? fmt::format("has {} morph targets; name one after #: {}", count, known)
            : fmt::format("\"{}\" is not one of its morph targets: {}", shown_text(name), known));
  }
  return static_cast<std::size_t>(found - names.begin());
}

// Primitives

/// Joins a mesh's primitives.
class Reader {
 public:
  Reader(GltfDocument& document, std::optional<std::size_t> target)
      : document_(document), target_(target) {}

  void read(const GltfItem& primitive) {
    const Index mode = primitive.whole("mode", triangle_list, 0, 6);
    if (mode < triangle_list) return;  // points and lines
    if (primitive.has("extensions") &&
        primitive.value["extensions"].contains("KHR_draco_mesh_compression")) {
      primitive.at.child("extensions")
          .refuse("compressed by Draco, which is not read: export without it");
    }
    const Vertices vertices = find_vertices(primitive);
    std::vector<Index> corners;
    if (primitive.has("indices")) {
      corners = read_indices(primitive.child("indices"), vertices.count);
    } else {
      for (Index i = 0; i < vertices.count; ++i) corners.push_back(i);
    }
    if (mode == triangle_list && corners.size() % 3 != 0) {
      primitive.at.refuse(fmt::format("{} corners are not those of triangles", corners.size()));
    }
    triangles_ += std::ssize(corners) / (mode == triangle_list ? 3 : 1);
    if (triangles_ > most_file_faces) {
      primitive.at.refuse(
          fmt::format("brings the mesh to {} triangles, not <= {}", triangles_, most_file_faces));
    }
    add_faces(corners, mode, vertices.first);
  }

  Mesh finish(const GltfItem& mesh) {
    if (faces_.empty()) mesh.at.refuse("has no triangle; a mesh is required");
    Mesh result;
    result.vertices = Eigen::Map<const Points>(positions_.data(), 3, std::ssize(positions_) / 3);
    result.faces = std::move(faces_);
    result.splits_seams = true;
    if (all_textured_) {
      result.texture_coordinates =
          Eigen::Map<const Points>(textures_.data(), 2, std::ssize(textures_) / 2);
      result.texture_corners = result.faces;
    }
    return result;
  }

 private:
  struct Vertices {
    Index first, count;  ///< in the joined mesh
  };

  /// Primitives that have the same accessors share their vertices.
  Vertices find_vertices(const GltfItem& primitive) {
    const GltfItem attributes = primitive.child("attributes");
    const GltfItem position = attributes.child("POSITION");
    std::optional<GltfItem> moved;
    if (target_) {
      if (!primitive.has("targets"))
        primitive.at.refuse("has no morph targets, as another of the mesh has");
      const GltfItem targets = primitive.child("targets");
      if (*target_ >= targets.size()) {
        targets.at.refuse(
            fmt::format("{} morph targets are fewer than another primitive's", targets.size()));
      }
      const GltfItem target = targets.child(*target_);
      if (target.has("POSITION")) moved.emplace(target.child("POSITION"));
    }
    const bool is_textured = attributes.has("TEXCOORD_0");
    const auto key = std::tuple(
        position.value, is_textured ? attributes.value["TEXCOORD_0"] : nlohmann::ordered_json(),
        moved ? moved->value : nlohmann::ordered_json());
    const auto [found, is_new] = known_.try_emplace(key);
    if (!is_new) return found->second;

    const Index left = most_file_vertices - std::ssize(positions_) / 3;
    Points points = document_.elements(position, {"VEC3", false, std::max<Index>(left, 1)});
    const Index count = points.cols();
    if (moved) points += of_each(*moved, "VEC3", count);
    found->second = {std::ssize(positions_) / 3, count};
    positions_.insert(positions_.end(), points.data(), points.data() + points.size());
    if (is_textured) {
      // A picture's first row is its upper one in glTF, its lower one in OBJ.
      Points texture = of_each(attributes.child("TEXCOORD_0"), "VEC2", count);
      texture.row(1) = 1 - texture.row(1).array();
      textures_.insert(textures_.end(), texture.data(), texture.data() + texture.size());
    }
    all_textured_ = all_textured_ && is_textured;
    return found->second;
  }

  /// An accessor with an element for each of so many vertices.
  Points of_each(const GltfItem& index, const char* type, Index count) {
    Points elements = document_.elements(index, {type, false, most_file_vertices});
    if (elements.cols() != count) {
      index.at.refuse(
          fmt::format("an accessor of {} elements has not one for each of the {} vertices",
                      elements.cols(), count));
    }
    return elements;
  }

  std::vector<Index> read_indices(const GltfItem& index, Index vertices) {
    const Points read = document_.elements(index, {"SCALAR", true, 3 * most_file_faces});
    std::vector<Index> corners;
    corners.reserve(static_cast<std::size_t>(read.size()));
    for (const double corner : read.reshaped()) {
      if (corner >= static_cast<double>(vertices)) {
        index.at.refuse(
            fmt::format("index {} names a vertex that is not among the {}", corner, vertices));
      }
      corners.push_back(static_cast<Index>(corner));
    }
    return corners;
  }

  /// Triangles in the order of their corners that glTF says; those without area by their indices,
  /// with which strips are joined, are left out.
  void add_faces(const std::vector<Index>& corners, Index mode, Index first) {
    const std::size_t step = mode == triangle_list ? 3 : 1;
    for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
      std::array at = {i, i + 1, i + 2};
      if (mode == triangle_strip && i % 2 == 1) std::swap(at[1], at[2]);
      if (mode == triangle_fan) at = {i + 1, i + 2, 0};
      const Index a = corners[at[0]], b = corners[at[1]], c = corners[at[2]];
      if (a != b && b != c && c != a) faces_.push_back({first + a, first + b, first + c});
    }
  }

  GltfDocument& document_;
  std::optional<std::size_t> target_;
  std::map<std::tuple<nlohmann::ordered_json, nlohmann::ordered_json, nlohmann::ordered_json>,
           Vertices>
      known_;
  std::vector<double> positions_, textures_;
  Faces faces_;
  Index triangles_ = 0;  // with those left out
  bool all_textured_ = true;
};

Mesh mesh_of(GltfDocument& document, const std::string& path,
             const std::optional<std::string>& target) {
  const GltfItem root = document.root();
  require_known_extensions(root);
  const GltfItem meshes = root.child("meshes");
  if (meshes.size() == 0) meshes.at.refuse("is empty; a mesh is required");
  const GltfItem mesh = meshes.child(std::size_t{0}), primitives = mesh.child("primitives");
  if (primitives.size() == 0) primitives.at.refuse("is empty; a mesh is required");
  Reader reader(document, target ? std::optional(find_target(mesh, *target)) : std::nullopt);
  for (std::size_t i = 0; i < primitives.size(); ++i) reader.read(primitives.child(i));
  Mesh result = reader.finish(mesh);
  const Eigen::Affine3d world = world_transform(root);
  for (Index i = 0; i < result.vertices.cols(); ++i) {  // each alone: copies must stay copies
    const Eigen::Vector3d at = result.vertices.col(i);
    result.vertices.col(i) = world.linear() * at + world.translation();
  }
  if (world.linear().determinant() < 0) {
    for (auto* faces : {&result.faces, &result.texture_corners}) {
      for (auto& face : *faces) std::ranges::reverse(face);
    }
  }
  if (meshes.size() > 1) {
    result.remarks.push_back(fmt::format("the first of the {} meshes in {}", meshes.size(), path));
  }
  return result;
}

}  // namespace

Mesh read_gltf(const std::string& path, const std::optional<std::string>& target) {
  GltfDocument document(path);
  return mesh_of(document, path, target);
}

Mesh parse_gltf(const std::string& bytes, const std::string& path,
                const std::optional<std::string>& target) {
  GltfDocument document(bytes, path);
  return mesh_of(document, path, target);
}

}  // namespace nuno
