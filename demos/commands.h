#pragma once

#include <nuno/flight_file.h>
#include <nuno/gains.h>
#include <nuno/search.h>
#include <nuno/throw_scene.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nuno {

/// What the program's exit status says.
enum class ExitStatus {
  done = 0,
  unwritable = 1,  ///< an output cannot be written
  bad_input = 2,   ///< bad usage or a bad scene
  diverged = 3     ///< the simulation diverged
};

/// One rollout; of a result its own, but for what is asked otherwise.
struct SimulateOptions {
  std::string scene;           ///< a file, of a scene or a result
  std::string backend;         ///< one of backend_names; empty: the result's, or native
  std::optional<Gains> gains;  ///< α ≥ 0 [N/m], 0 is launch only; absent: the result's, or 0
  SceneChanges changes;
  /// Animation (one of animation_extensions), else result file; "-" for standard output, empty for
  /// none.
  std::string out;
  AnimationOptions animation;
};

/// The search for the best gain.
struct OptimizeOptions {
  std::string scene;               ///< a file
  std::string backend = "native";  ///< one of backend_names
  SearchOptions search;
  SceneChanges changes;
  /// Animation (one of animation_extensions), else result file; "-" for standard output, empty for
  /// none.
  std::string out;
  AnimationOptions animation;
};

/// A cloth of two meshes or drawings thrown with what an animator wants: along a damped morph, at
/// the best gain.
struct ThrowOptions {
  std::string start, target;  ///< files, see throw_scene; `target` may be empty
  ThrowRequest request;
  std::string backend = "native";     ///< one of backend_names
  bool reverses_target = false;       ///< of drawings: the line from its other end
  bool refine = false;                ///< as of the search
  std::optional<double> error_limit;  ///< as of the search
  std::string out;                    ///< as of the others
  AnimationOptions animation;
};

/// Both engines on the same scenes.
struct CompareOptions {
  std::vector<std::string> scenes;  ///< files, and folders of *.json
  std::string out;                  ///< folder, "-" for compare.json on standard output, or none
};

/// Many scenes, each thrown at its best gain.
struct BatchOptions {
  std::vector<std::string> shots;  ///< files of scenes, and folders of *.json
  std::string out;                 ///< folder of the results
  std::string backend = "native";  ///< one of backend_names
  Index jobs = 0;                  ///< shots at once, a core each; 0: as many as there are cores
  Index part = 1, parts = 1;       ///< of the shots: every `parts`-th, from the `part`-th on
};

/// The paper's figures from our own runs.
struct FiguresOptions {
  std::string out = "figures";  ///< folder
};

/// The files that `render` writes: a still or moving SVG, a still, films.
inline constexpr std::array<std::string_view, 5> render_extensions = {".svg", ".png", ".gif",
                                                                      ".mp4", ".webm"};

/// Pictures and films of results.
struct RenderOptions {
  std::vector<std::string> results;  ///< result files; a scene file is thrown at its best gain
  std::string out;                   ///< file with one of render_extensions
  bool still = false;                ///< an SVG that does not move
  bool plain = false;                ///< shapes alone: no axes, no text
  double speed = 1;                  ///< of a film over that of the flight, > 0
};

// The commands. They throw InputError and OutputError, and say themselves why a rollout diverged.
ExitStatus simulate(const SimulateOptions& options);
ExitStatus optimize(const OptimizeOptions& options);
ExitStatus throw_cloth(const ThrowOptions& options);
ExitStatus compare(const CompareOptions& options);
ExitStatus throw_batch(const BatchOptions& options);
ExitStatus make_figures(const FiguresOptions& options);
ExitStatus render(const RenderOptions& options);

}  // namespace nuno
