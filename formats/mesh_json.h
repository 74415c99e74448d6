#pragma once

#include <nuno/mesh.h>

#include <array>
#include <string_view>

#include <nlohmann/json.hpp>

#include "json_field.h"

// A sheet's mesh within a scene of JSON, as results hold it: nothing else is needed to fly it.

namespace nuno {

/// The fields besides `initial` and `target`, the vertices in either pose.
inline constexpr std::array<std::string_view, 4> mesh_fields = {"faces", "texture_coordinates",
                                                                "texture_corners", "file_vertices"};

/// Reads the mesh of such a scene in its initial pose, at `root`.
Mesh read_mesh(const nlohmann::ordered_json& scene, const Field& root);

/// Reads the vertices of a pose.
Points read_vertices(const nlohmann::ordered_json& scene, const Field& root, const char* name);

/// Writes these fields, those that are not empty.
void write_mesh(nlohmann::ordered_json& scene, const Mesh& mesh);

}  // namespace nuno
