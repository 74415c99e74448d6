#pragma once

#include <nuno/scene_file.h>

#include <string>

#include <nlohmann/json.hpp>

namespace nuno {

/// A whole scene as JSON: of a sheet with its mesh, in place of the names of mesh files.
nlohmann::ordered_json json_of(const AnyScene& scene);

/// The same read, and validated; meshes that are named are in `folder`.
AnyScene scene_from(const nlohmann::ordered_json& json, const std::string& source,
                    const std::string& folder);

}  // namespace nuno
