#pragma once

#include <nuno/mesh.h>
#include <nuno/scene.h>

#include <string>
#include <variant>

namespace nuno {

/// A scene as its file gives it.
struct SheetInput {
  SheetScene scene;
  Mesh mesh;  ///< of the initial shape, with what goes out again: texture coordinates
};
using AnyScene = std::variant<ChainScene, SheetInput>;

/// Reads and validates a scene: a chain's, or, where `initial` and `target` name mesh files or are
/// meshes themselves, a sheet's; "-" is standard input. A field that is left out has the default
/// above; an unknown one is an error that names the nearest known one. The scene is named after the
/// file unless it names itself.
AnyScene read_scene(const std::string& path);

/// The same from the text that is in the file at `path`.
AnyScene parse_any_scene(const std::string& text, const std::string& path);

/// The same from text alone, whose meshes stand in it: no file is read.
AnyScene parse_whole_scene(const std::string& text, const std::string& source);

/// The same from JSON text, of a chain alone: a text has no folder that meshes could be in.
ChainScene parse_scene(const std::string& json, const std::string& source);

/// The scene as JSON text, a sheet's with its meshes in it; reading it gives the same scene to the
/// last bit.
std::string to_json(const ChainScene& scene);
std::string to_json(const SheetInput& sheet);

/// Gives a sheet's scene its shapes from two mesh files, and validates it; `source` names the scene
/// in messages.
SheetInput with_meshes(SheetScene scene, const std::string& initial, const std::string& target,
                       const std::string& source);
/// The same from meshes that were read from files of these names.
SheetInput with_meshes(SheetScene scene, const std::string& initial, Mesh start,
                       const std::string& target, Mesh end, const std::string& source);

}  // namespace nuno
