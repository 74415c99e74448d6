#include <nuno/input.h>
#include <nuno/mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "encoding.h"
#include "text_file.h"

namespace nuno {
namespace {

bool has_extension(std::string_view path, std::string_view extension) {
  return path.size() >= extension.size() &&
         std::ranges::equal(path.substr(path.size() - extension.size()), extension,
                            [](char a, char b) { return a == b || a + ('a' - 'A') == b; });
}

bool is_gltf(std::string_view path) {
  return has_extension(path, ".gltf") || has_extension(path, ".glb");
}

/// Of FILE.glb#NAME.
std::optional<std::string> morph_target(const std::string& path) {
  const std::string file = mesh_file(path);
  return file == path ? std::nullopt : std::optional(path.substr(file.size() + 1));
}

void require_text_mesh(const std::string& path) {
  if (has_extension(path, ".obj") || has_extension(path, ".ply")) return;
  throw InputError(fmt::format("{}: does not end in .obj, .ply, .gltf or .glb", path));
}

}  // namespace

std::string mesh_file(const std::string& path) {
  const std::size_t hash = path.find('#');
  return hash != std::string::npos && is_gltf(path.substr(0, hash)) ? path.substr(0, hash) : path;
}

bool may_have_morph_targets(const std::string& path) { return is_gltf(mesh_file(path)); }

Mesh read_mesh(const std::string& path) {
  if (may_have_morph_targets(path)) return read_gltf(mesh_file(path), morph_target(path));
  require_text_mesh(path);
  return parse_mesh(read_file(path, path, "a mesh", largest_file), path);
}

Mesh parse_mesh(const std::string& bytes, const std::string& path) {
  if (may_have_morph_targets(path)) {
    return parse_gltf(bytes, mesh_file(path), morph_target(path));
  }
  require_text_mesh(path);
  const bool is_obj = has_extension(path, ".obj");
  if (is_obj) require_text(bytes, path);
  return is_obj ? parse_obj(bytes, path) : parse_ply(bytes, path);
}

}  // namespace nuno
