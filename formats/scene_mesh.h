#pragma once

#include <nuno/mesh.h>

#include <nlohmann/json.hpp>

#include "json_field.h"

// Meshes that stand in a scene itself, so that it is whole without other files:
//   "initial": {"vertices": [[x, y, z], …], "faces": [[0, 1, 2], …]},
//   "target": {"vertices": [[x, y, z], …]}
// Vertices count from 0. "initial" may also have "texture_coordinates" [[u, v], …] with
// "texture_corners", as many as faces, and "file_vertices" (see mesh.h): what goes out again.

namespace nuno {

/// The mesh of `initial`, or, with `is_pose`, that of `target`, which has vertices alone. Throws
/// InputError for a field that is missing, unknown or not of this form.
Mesh mesh_in_scene(const nlohmann::ordered_json& value, const Field& at, bool is_pose);

/// The mesh as `initial` has it.
nlohmann::ordered_json json_of(const Mesh& mesh);

}  // namespace nuno
