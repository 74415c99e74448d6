#pragma once

#include <nuno/scene.h>

#include <string>

namespace nuno {

/// Reads and validates a scene from JSON text. A field that is left out has the default above; an
/// unknown one is an error that names the nearest known one.
ChainScene parse_scene(const std::string& json, const std::string& source);

/// The same from a file. The scene is named after the file unless it names itself.
ChainScene read_scene(const std::string& path);

/// The scene as JSON text; reading it gives the same scene to the last bit.
std::string to_json(const ChainScene& scene);

}  // namespace nuno
