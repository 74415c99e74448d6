#pragma once

#include <nuno/mesh.h>

#include <optional>
#include <string>
#include <utility>

namespace nuno::studio {

struct Upload {
  std::string path;  ///< for messages
  Mesh mesh;
};

/// The start and the target of {"initial": {"name": "flag.obj", "data": BASE64}, "target": {…}}.
/// Without a target, the only morph target of the start. Throws InputError.
std::pair<Upload, Upload> read_meshes(const std::string& body);

/// Drawn lines [2 × any each].
struct Drawings {
  std::optional<Points> initial;
  Points target;
};

/// The same of drawings, .svg or .csv, of a line each; a single one, as `target`, may also be an
/// SVG with the curves `initial` and `target`. Throws InputError.
Drawings read_drawings(const std::string& body);

}  // namespace nuno::studio
