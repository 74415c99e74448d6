#include <nuno/glb_file.h>

#include <nuno/output.h>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <bit>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

static_assert(std::endian::native == std::endian::little, "glTF's numbers are little-endian");

namespace nuno {
namespace {

using Json = nlohmann::ordered_json;
using Floats = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// Numbers of the format.
constexpr std::uint32_t magic = 0x46546C67, version = 2, json_chunk = 0x4E4F534A,
                        binary_chunk = 0x004E4942;
constexpr int float_type = 5126, index_type = 5125, vertex_data = 34962, index_data = 34963;

/// The mesh as glTF wants it: a vertex has one texture point, so that one on a seam stands twice.
/// Vertex i of the mesh is vertex i of ours; the twins stand behind them.
struct Corners {
  std::vector<Index> vertex;   ///< of the mesh, for each of ours
  std::vector<Index> texture;  ///< its texture point; empty where the mesh has none
  Triangles triangles;         ///< of ours
};

Corners split(const Mesh& mesh, const Points& shape) {
  Corners corners;
  const bool textured = !mesh.texture_corners.empty();
  constexpr Index none = -1;
  corners.vertex.resize(static_cast<std::size_t>(shape.cols()));
  std::iota(corners.vertex.begin(), corners.vertex.end(), Index{0});
  if (textured) corners.texture.resize(corners.vertex.size(), none);
  std::map<std::pair<Index, Index>, Index> twins;  // by vertex and texture point
  const auto ours = [&](Index vertex, Index texture) {
    if (!textured) return vertex;
    Index& first = corners.texture[static_cast<std::size_t>(vertex)];
    if (first == none) first = texture;
    if (first == texture) return vertex;
    const auto [at, is_new] = twins.try_emplace({vertex, texture}, std::ssize(corners.vertex));
    if (is_new) {
      corners.vertex.push_back(vertex);
      corners.texture.push_back(texture);
    }
    return at->second;
  };
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const std::vector<Index>& face = mesh.faces[f];
    std::vector<std::uint32_t> around;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index texture = textured ? mesh.texture_corners[f][k] : 0;
      around.push_back(static_cast<std::uint32_t>(ours(face[k], texture)));
    }
    for (const auto& [a, b, c] : triangulated(shape(Eigen::all, face))) {
      corners.triangles.push_back({around[static_cast<std::size_t>(a)],
                                   around[static_cast<std::size_t>(b)],
                                   around[static_cast<std::size_t>(c)]});
    }
  }
  return corners;
}

/// Unit normals of the vertices, the mean of their triangles' by area [3 × N].
Points normals(const Corners& corners, const Points& shape) {
  Points sum = Points::Zero(3, shape.cols());
  for (const auto& triangle : corners.triangles) {
    const Index a = corners.vertex[triangle[0]], b = corners.vertex[triangle[1]],
                c = corners.vertex[triangle[2]];
    const Eigen::Vector3d to_b = shape.col(b) - shape.col(a), to_c = shape.col(c) - shape.col(a);
    const Eigen::Vector3d normal = to_b.cross(to_c);
    for (const Index i : {a, b, c}) sum.col(i) += normal;
  }
  for (Index i = 0; i < sum.cols(); ++i) {
    const double length = sum.col(i).norm();
    sum.col(i) = length > 0 ? Eigen::Vector3d(sum.col(i) / length) : Eigen::Vector3d::UnitY();
  }
  return sum;
}

/// Builds the JSON chunk, and the layout of the binary one with it.
class Document {
 public:
  /// Adds `count` items of `size` bytes and returns the accessor's number.
  std::size_t add(std::size_t count, std::size_t size, Json accessor, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", count * size}};
    if (target != 0) view["target"] = target;
    accessor["bufferView"] = views_.size();
    accessor["count"] = count;
    views_.push_back(view);
    accessors_.push_back(std::move(accessor));
    bytes_ += count * size;
    return accessors_.size() - 1;
  }

  std::size_t add_vectors(const Floats& values, bool bounded) {
    Json accessor = {{"componentType", float_type}, {"type", values.rows() == 3 ? "VEC3" : "VEC2"}};
    if (bounded) {
      const Eigen::VectorXf least = values.rowwise().minCoeff(), most = values.rowwise().maxCoeff();
      accessor["min"] = std::vector<float>(least.begin(), least.end());
      accessor["max"] = std::vector<float>(most.begin(), most.end());
    }
    return add(static_cast<std::size_t>(values.cols()),
               static_cast<std::size_t>(values.rows()) * sizeof(float), accessor, vertex_data);
  }

  std::size_t add_scalars(const std::vector<float>& values, bool bounded) {
    Json accessor = {{"componentType", float_type}, {"type", "SCALAR"}};
    if (bounded) {
      accessor["min"] = {values.front()};
      accessor["max"] = {values.back()};
    }
    return add(values.size(), sizeof(float), accessor, 0);
  }

  std::size_t bytes() const { return bytes_; }
  const Json& views() const { return views_; }
  const Json& accessors() const { return accessors_; }

 private:
  Json views_ = Json::array(), accessors_ = Json::array();
  std::size_t bytes_ = 0;
};

void write(std::FILE* file, const void* data, std::size_t size) {
  if (size > 0) std::fwrite(data, 1, size, file);  // nothing may stand nowhere
}

void write_words(std::FILE* file, std::initializer_list<std::uint32_t> words) {
  for (const std::uint32_t word : words) write(file, &word, sizeof word);
}

/// A flight's shapes in the numbers of the file.
struct Shapes {
  const Corners& corners;
  const std::vector<Points>& positions;
  Floats first, first_normals;

  Shapes(const Corners& of, const std::vector<Points>& frames)
      : corners(of),
        positions(frames),
        first(frames.front()(Eigen::all, of.vertex).cast<float>()),
        first_normals(normals(of, frames.front())(Eigen::all, of.vertex).cast<float>()) {}

  /// From the first frame to frame k. Of the numbers that a reader will add to: what is lost in the
  /// first frame's rounding is in here.
  Floats moved(std::size_t k) const {
    return (positions[k](Eigen::all, corners.vertex) - first.cast<double>()).cast<float>();
  }
  Floats turned(std::size_t k) const {
    return (normals(corners, positions[k])(Eigen::all, corners.vertex) -
            first_normals.cast<double>())
        .cast<float>();
  }
};

/// One node, with a mesh of this primitive.
Json scene_with(const std::string& name, const Json& primitive) {
  return {{"asset", {{"version", "2.0"}, {"generator", "nuno"}}},
          {"scene", 0},
          {"scenes", {{{"nodes", {0}}}}},
          {"nodes", {{{"name", name}, {"mesh", 0}}}},
          {"materials",
           {{{"name", "cloth"},
             {"doubleSided", true},
             {"pbrMetallicRoughness",
              {{"baseColorFactor", {0.55, 0.18, 0.16, 1.0}},
               {"metallicFactor", 0.0},
               {"roughnessFactor", 0.8}}}}}},
          {"meshes", {{{"name", name}, {"primitives", {primitive}}}}}};
}

/// All that stands before the bytes of the buffer; false where the file would be too large.
bool write_head(std::FILE* file, const Json& gltf, std::size_t bytes) {
  std::string head = gltf.dump(-1, ' ', false, Json::error_handler_t::replace);
  head.resize((head.size() + 3) / 4 * 4, ' ');
  const std::size_t total = 12 + 8 + head.size() + 8 + bytes;
  if (total > std::numeric_limits<std::uint32_t>::max()) return false;
  write_words(file, {magic, version, static_cast<std::uint32_t>(total)});
  write_words(file, {static_cast<std::uint32_t>(head.size()), json_chunk});
  write(file, head.data(), head.size());
  write_words(file, {static_cast<std::uint32_t>(bytes), binary_chunk});
  return true;
}

}  // namespace

void write_glb(std::FILE* file, const std::string& name, const Mesh& mesh,
               const std::vector<double>& times, const std::vector<Points>& positions) {
  const Corners corners = split(mesh, positions.front());
  const Shapes shapes(corners, positions);
  const std::size_t targets = positions.size() - 1;

  Document document;
  Json attributes = {{"POSITION", document.add_vectors(shapes.first, true)},
                     {"NORMAL", document.add_vectors(shapes.first_normals, false)}};
  Floats texture;
  if (!corners.texture.empty()) {
    // A picture's first row is its upper one in glTF, its lower one in OBJ.
    texture = mesh.texture_coordinates(Eigen::all, corners.texture).cast<float>();
    texture.row(1) = 1 - texture.row(1).array();
    attributes["TEXCOORD_0"] = document.add_vectors(texture, false);
  }
  const std::size_t indices =
      document.add(3 * corners.triangles.size(), sizeof(std::uint32_t),
                   {{"componentType", index_type}, {"type", "SCALAR"}}, index_data);
  Json primitive = {{"attributes", attributes}, {"indices", indices}, {"material", 0}};
  Json weights = Json::array(), names = Json::array();
  for (std::size_t k = 1; k <= targets; ++k) {
    primitive["targets"].push_back({{"POSITION", document.add_vectors(shapes.moved(k), true)},
                                    {"NORMAL", document.add_vectors(shapes.turned(k), false)}});
    weights.push_back(0);
    names.push_back(fmt::format("{:.4f} s", times[k]));
  }
  Json gltf = scene_with(name, primitive);
  std::vector<float> keys(times.begin(), times.end()), values;
  if (targets > 0) {
    gltf["meshes"][0]["weights"] = weights;
    gltf["meshes"][0]["extras"] = {{"targetNames", names}};
    for (std::size_t frame = 0; frame < positions.size(); ++frame) {
      for (std::size_t k = 1; k <= targets; ++k) values.push_back(k == frame ? 1.F : 0.F);
    }
    const std::size_t input = document.add_scalars(keys, true);
    const std::size_t output = document.add_scalars(values, false);
    gltf["animations"] = {
        {{"name", "flight"},
         {"samplers", {{{"input", input}, {"output", output}, {"interpolation", "LINEAR"}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
  }
  gltf["bufferViews"] = document.views();
  gltf["accessors"] = document.accessors();
  gltf["buffers"] = {{{"byteLength", document.bytes()}}};

  if (!write_head(file, gltf, document.bytes())) {
    throw OutputError(fmt::format("{} frames of {} vertices are more than the 4 GiB of a .glb",
                                  positions.size(), corners.vertex.size()));
  }
  const auto write_floats = [&](const Floats& all) {
    write(file, all.data(), static_cast<std::size_t>(all.size()) * sizeof(float));
  };
  write_floats(shapes.first);
  write_floats(shapes.first_normals);
  write_floats(texture);
  write(file, corners.triangles.data(), corners.triangles.size() * sizeof(corners.triangles[0]));
  for (std::size_t k = 1; k <= targets; ++k) {
    write_floats(shapes.moved(k));
    write_floats(shapes.turned(k));
  }
  if (targets > 0) {
    write(file, keys.data(), keys.size() * sizeof(float));
    write(file, values.data(), values.size() * sizeof(float));
  }
}

}  // namespace nuno
