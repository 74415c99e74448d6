#include <nuno/mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "file_text.h"

namespace nuno {
namespace {

constexpr std::uintmax_t largest_file = 256 << 20;  // bytes: millions of vertices

bool has_extension(std::string_view path, std::string_view extension) {
  return path.size() >= extension.size() &&
         std::ranges::equal(path.substr(path.size() - extension.size()), extension,
                            [](char a, char b) { return a == b || a + ('a' - 'A') == b; });
}

bool is_gltf(std::string_view path) {
  return has_extension(path, ".gltf") || has_extension(path, ".glb");
}

}  // namespace

std::string file_text(const std::string& path, const std::string& name, std::uintmax_t most) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(fmt::format("{}: is a directory, not a file", name));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: cannot be opened for reading", name));
  std::string text;
  std::vector<char> block(1 << 16);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(file.gcount()));
    if (text.size() > most) {
      throw InputError(fmt::format("{}: is larger than {} MiB", name, most >> 20));
    }
  }
  if (file.bad()) throw InputError(fmt::format("{}: cannot be read", name));
  return text;
}

std::string mesh_file(const std::string& path) {
  const std::size_t hash = path.find('#');
  return hash != std::string::npos && is_gltf(path.substr(0, hash)) ? path.substr(0, hash) : path;
}

bool may_have_morph_targets(const std::string& path) { return is_gltf(mesh_file(path)); }

Mesh read_mesh(const std::string& path) {
  if (may_have_morph_targets(path)) {
    const std::string file = mesh_file(path);
    return read_gltf(file,
                     file == path ? std::nullopt : std::optional(path.substr(file.size() + 1)));
  }
  const bool is_obj = has_extension(path, ".obj"), is_ply = has_extension(path, ".ply");
  if (!is_obj && !is_ply) {
    throw InputError(fmt::format("{}: does not end in .obj, .ply, .gltf or .glb", path));
  }
  const std::string text = file_text(path, path, largest_file);
  return is_obj ? parse_obj(text, path) : parse_ply(text, path);
}

}  // namespace nuno
