#pragma once

#include <nuno/backend.h>
#include <nuno/optimize.h>
#include <nuno/refine.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace nuno {

/// A scene file, read, validated and resampled.
struct SceneFile {
  std::string path;
  ChainScene scene;
  Problem problem;
};

/// `time_step`, if given, takes the place of the scene's.
SceneFile read_scene_file(const std::string& path, std::optional<double> time_step = std::nullopt);

/// The same from JSON text that messages call `path`.
SceneFile parse_scene_file(const std::string& json, const std::string& path);

/// Frames per second with which a flight of this scene holds so many points [1/s].
double frames_per_second_of(double points, const ChainScene& scene);

/// Throws InputError if a result of this scene would hold more frames than memory does.
void require_few_frames(const SceneFile& file);

/// Throws InputError for a scene that is too large for refine_on.
void require_few_particles_to_refine(const SceneFile& file);

/// Throws InputError if the scene's particles have too few modes for so many groups of them.
void require_groups(const SceneFile& file, Index groups);

inline constexpr std::array<std::string_view, 2> backend_names = {"native", "box2d"};

/// The engine called `name`, one of backend_names, made ready for the scene. Throws InputError
/// where one rollout would take hours.
std::unique_ptr<Backend> make_backend(std::string_view name, const SceneFile& file);

/// The same with a step that is short enough for `gain` as well.
std::unique_ptr<Backend> make_backend_for_gain(std::string_view name, const SceneFile& file,
                                               double gain);

/// Makes the engine called `name` for the scene's problem corrected elsewhere, see refine.h; `name`
/// and `file` must outlive it.
MakeBackend backend_maker(std::string_view name, const SceneFile& file);

/// Refines on the native chain at its tracking gain, and transfers the answer to the engine
/// called `name`. `before_rollout` is called before each rollout and jacobian; what it throws ends
/// the work.
RefineSummary refine_on(std::string_view name, const SceneFile& file,
                        const RefineOptions& options = {},
                        const std::function<void()>& before_rollout = {});

inline constexpr std::array<std::string_view, 2> optimizer_names = {"global", "steepest-descent"};

/// Runs the optimiser called `name`, one of optimizer_names.
OptimizeSummary run_optimizer(std::string_view name, const Objective& objective);

}  // namespace nuno
