#pragma once

#include <nuno/backend.h>
#include <nuno/optimize.h>
#include <nuno/refine.h>
#include <nuno/rollout.h>
#include <nuno/scene_file.h>

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace nuno {

/// A scene file, or the scene of a result, read, validated and made ready to be flown.
struct SceneFile {
  std::string path;
  Scene scene;  ///< what is asked, whatever the cloth's form
  Problem problem;
  AnyScene input = {};                    ///< the whole scene, as it is given
  std::optional<PastFlight> flight = {};  ///< of a result; the problem does not know it

  /// Of a sheet's initial shape; null for a chain.
  const Mesh* mesh() const {
    const auto* const sheet = std::get_if<SheetInput>(&input);
    return sheet ? &sheet->mesh : nullptr;
  }
};

/// `path` is what messages call the scene.
SceneFile make_scene_file(const std::string& path, AnyScene scene);

/// What a command asks of a scene otherwise than its file.
struct SceneChanges {
  std::optional<double> time_step = {};  ///< [s], > 0
  bool reverses_target = false;          ///< of a chain
};

/// The chain's scene with its target from the other end; throws InputError for a sheet's.
AnyScene with_reversed_target(AnyScene scene, const std::string& source);

SceneFile read_scene_file(const std::string& path, const SceneChanges& changes = {});

/// Frames per second with which a flight of this scene holds so many points [1/s].
double frames_per_second_of(double points, const SceneFile& file);

/// Throws InputError if a flight of this scene, with frames for some `more` seconds before it or
/// after, would hold more of them than memory does.
void require_few_frames(const SceneFile& file, double more = 0);

/// Throws InputError where so long a flight after arrival [s] would take hours.
void require_short_tail(const Backend& backend, double tail);

/// Throws InputError for a scene that refine_on cannot take: too large a chain.
void require_refinable(const SceneFile& file);

/// Throws InputError if the scene's particles have too few modes for so many groups of them.
void require_groups(const SceneFile& file, Index groups);

/// An engine, and what it flies.
struct EngineEntry {
  std::string_view name;             ///< for files and options, as Backend::name
  std::string_view name_for_people;  ///< for figures and pages
  bool flies_chains, flies_sheets;
};

/// Every engine there is; the one of the project first.
inline constexpr std::array<EngineEntry, 3> all_engines = {{{"native", "native", true, true},
                                                            {"box2d", "Box2D", true, false},
                                                            {"bullet", "Bullet", false, true}}};

/// The names of `count` engines that are `wanted`.
template <std::size_t count, typename Wanted>
consteval std::array<std::string_view, count> names_of(Wanted wanted) {
  std::array<std::string_view, count> names;
  std::size_t n = 0;
  for (const EngineEntry& engine : all_engines) {
    if (std::invoke(wanted, engine)) names[n++] = engine.name;
  }
  return names;
}

/// The two engines that fly chains, and those that fly sheets; the one of the project first.
inline constexpr auto chain_engines = names_of<2>(&EngineEntry::flies_chains);
inline constexpr auto sheet_engines = names_of<2>(&EngineEntry::flies_sheets);
inline constexpr auto backend_names =
    names_of<all_engines.size()>([](const EngineEntry&) { return true; });

/// Those that fly the problem's cloth.
inline const std::array<std::string_view, 2>& engines_for(const Problem& problem) {
  return problem.is_sheet() ? sheet_engines : chain_engines;
}

/// The engine called `name`, one of backend_names, made ready for the scene. Throws InputError
/// where it does not fly such a cloth, or where one rollout would take hours.
std::unique_ptr<Backend> make_backend(std::string_view name, const SceneFile& file);

/// The same with a step that is short enough for `gain` as well, which messages call `option`.
std::unique_ptr<Backend> make_backend_for_gain(std::string_view name, const SceneFile& file,
                                               double gain, std::string_view option = "--alpha");

/// The backend's engine at `share` of its step, for the scene; null where its flight would take
/// hours.
std::unique_ptr<Backend> at_finer_step(const Backend& backend, const SceneFile& file, double share);

/// A rollout, the engine that flew it, and how far it can be trusted.
struct JudgedRollout {
  std::unique_ptr<Backend> finer;  ///< null: the one that was asked
  Rollout flight;                  ///< with its step error where its step is doubtful
  double sensitivity = std::numeric_limits<double>::infinity();  ///< bounded; ∞ where it diverged
};

/// A rollout of the scene on its backend. A doubtful step is measured, unless that would take
/// hours, see conditioning.h. Where it diverges, and the scene leaves the step to the engine, it is
/// flown at a quarter and at a sixteenth of the step.
JudgedRollout judged_rollout(const Backend& backend, const SceneFile& file, const Gains& gains,
                             const RolloutOptions& options = {});

/// Makes the engine called `name` for the scene's problem corrected elsewhere, see refine.h; `name`
/// and `file` must outlive it.
MakeBackend backend_maker(std::string_view name, const SceneFile& file);

/// Refines on the native engine at its tracking gain, and transfers the answer to the engine
/// called `name`.
RefineSummary refine_on(std::string_view name, const SceneFile& file,
                        const RefineOptions& options = {});

inline constexpr std::array<std::string_view, 2> optimizer_names = {"global", "steepest-descent"};

/// Runs the optimiser called `name`, one of optimizer_names.
OptimizeSummary run_optimizer(std::string_view name, const Objective& objective);

}  // namespace nuno
