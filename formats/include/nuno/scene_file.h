#pragma once

#include <nuno/gains.h>
#include <nuno/mesh.h>
#include <nuno/scene.h>

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace nuno {

/// A scene as its file gives it.
struct SheetInput {
  SheetScene scene;
  Mesh mesh;  ///< of the initial shape, with what goes out again: texture coordinates
};
using AnyScene = std::variant<ChainScene, SheetInput>;

/// What is asked, whatever the cloth's form.
const Scene& scene_of(const AnyScene& scene);

/// How the flight of a result was flown.
struct PastFlight {
  std::string backend;
  Gains gains = 0;
  Index steps = 0;                           ///< ≥ 1
  std::vector<Points> reference_correction;  ///< as in Problem
};

/// A scene, or that of a result file and how it was flown.
struct SceneOrResult {
  AnyScene scene;
  std::optional<PastFlight> flight;
};

/// Reads and validates a scene: a chain's, or a sheet's, where `initial` and `target` name mesh
/// files or there are `faces`; "-" is standard input. A field that is left out has the default
/// above; an unknown one is an error that names the nearest known one. The scene is named after the
/// file unless it names itself.
AnyScene read_scene(const std::string& path);

/// The same from the text that is in the file at `path`.
AnyScene parse_any_scene(const std::string& text, const std::string& path);

/// The same of a result file as well (see result_file.h).
SceneOrResult read_scene_or_result(const std::string& path);

/// The same from JSON text, of a chain alone: a text has no folder that meshes could be in.
ChainScene parse_scene(const std::string& json, const std::string& source);

/// The chain's scene as JSON text; reading it gives the same scene to the last bit.
std::string to_json(const ChainScene& scene);

/// Gives a sheet's scene its shapes from two mesh files, and validates it; `source` names the scene
/// in messages.
SheetInput with_meshes(SheetScene scene, const std::string& initial, const std::string& target,
                       const std::string& source);

}  // namespace nuno
