#include <nuno/output.h>

#include <fmt/format.h>

#include "animation_files.h"

namespace nuno {

void write_obj(std::FILE* file, const std::string& name, const Mesh& mesh, const Points& shape) {
  fmt::print(file, "o {}\n", printable(name));
  for (const auto& at : shape.colwise()) fmt::print(file, "v {}\n", fmt::join(at, " "));
  const bool textured = !mesh.texture_corners.empty();
  if (textured) {
    for (const auto& at : mesh.texture_coordinates.colwise()) {
      fmt::print(file, "vt {}\n", fmt::join(at, " "));
    }
  }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    fmt::print(file, "f");
    for (std::size_t k = 0; k < mesh.faces[f].size(); ++k) {
      fmt::print(file, " {}", mesh.faces[f][k] + 1);
      if (textured) fmt::print(file, "/{}", mesh.texture_corners[f][k] + 1);
    }
    fmt::print(file, "\n");
  }
}

}  // namespace nuno
