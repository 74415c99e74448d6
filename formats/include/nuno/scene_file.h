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

/// A cloth's two shapes as points: with faces a sheet's vertices in two poses [3 × N], without them
/// a chain's drawn lines [2 × any].
struct Shapes {
  Points initial, target;
  Faces faces = {};
};

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

/// Reads and validates a scene: a chain's, or, where `initial` and `target` name mesh files or are
/// meshes themselves, a sheet's; "-" is standard input. A field that is left out has the default
/// above; an unknown one is an error that names the nearest known one. The scene is named after the
/// file unless it names itself.
AnyScene read_scene(const std::string& path);

/// The same from the text that is in the file at `path`.
AnyScene parse_any_scene(const std::string& text, const std::string& path);

/// The same from text alone, whose meshes stand in it: no file is read.
AnyScene parse_whole_scene(const std::string& text, const std::string& source);

/// The same of a result file as well (see result_file.h).
SceneOrResult read_scene_or_result(const std::string& path);

/// The same from JSON text, of a chain alone: a text has no folder that meshes could be in.
ChainScene parse_scene(const std::string& json, const std::string& source);

/// The same from JSON text without `initial` and `target`, whose place these shapes take.
AnyScene parse_scene_of(const Shapes& shapes, const std::string& json, const std::string& source);

/// Gives a scene its shapes, and validates it; `source` names the scene in messages.
ChainScene with_shapes(ChainScene scene, const Shapes& shapes, const std::string& source);
SheetInput with_shapes(SheetScene scene, const Shapes& shapes, const std::string& source);

/// The fields of a scene but for its shapes, as JSON text; parse_scene_of reads them to the last
/// bit. The values of a named material stand for its name.
std::string fields_to_json(const AnyScene& scene);

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
