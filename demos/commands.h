#pragma once

#include <nuno/engines.h>
#include <nuno/gains.h>

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

/// How a flight lies in the shot, for a file that holds an animation.
struct AnimationOptions {
  Index first_frame = 1;  ///< number of the first frame, ≥ 0
  Index held_frames = 0;  ///< of the initial shape before the throw, ≥ 0
  double tail = 0;        ///< flight after arrival, without control [s], ≥ 0
  std::optional<double>
      ribbon_width;  ///< of a chain's mesh [m], > 0; absent: a tenth of its length
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
  std::string scene;                 ///< a file
  std::string backend = "native";    ///< one of backend_names
  std::string optimizer = "global";  ///< one of optimizer_names
  /// Least effort within this error, over the cloth's length; takes the optimiser's place.
  std::optional<double> error_limit;
  /// Least error within this control effort; takes the optimiser's place.
  std::optional<double> effort_limit;
  Index coefficients = 1;  ///< gains by group of modes, 1 … most_groups
  bool refine = false;     ///< corrects the reference until the cloth is on the target
  bool robust = false;     ///< the error averaged over small perturbations of the start
  SceneChanges changes;
  /// Animation (one of animation_extensions), else result file; "-" for standard output, empty for
  /// none.
  std::string out;
  AnimationOptions animation;
};

/// A cloth of two meshes or drawings thrown with what an animator wants: along a damped morph, at
/// the best gain.
struct ThrowOptions {
  /// Mesh files, the same faces in two poses; or curves, see drawing.h. Without a target, `start`
  /// is a mesh with one morph target, or a drawing with two curves called "initial" and "target".
  std::string start, target;
  double arrival_time = 0;            ///< t₀ [s], > 0
  std::string material;               ///< of a mesh, one of named_materials; empty: default values
  std::string backend = "native";     ///< one of backend_names
  double frames_per_second = 24;      ///< of the animation [1/s], > 0
  bool settle = false;                ///< the cloth comes to rest on the target
  bool reverses_target = false;       ///< of drawings: the line from its other end
  std::optional<double> error_limit;  ///< as of the search
  std::string out;                    ///< as of the others
  AnimationOptions animation;
};

/// Both engines on the same scenes.
struct CompareOptions {
  std::vector<std::string> scenes;  ///< files, and folders of *.json
  std::string out;                  ///< folder, "-" for compare.json on standard output, or none
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
ExitStatus make_figures(const FiguresOptions& options);
ExitStatus render(const RenderOptions& options);

}  // namespace nuno
