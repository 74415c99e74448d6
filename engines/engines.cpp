#include <nuno/engines.h>

#include <fmt/format.h>

#include <nuno/box2d.h>
#include <nuno/bullet.h>
#include <nuno/conditioning.h>
#include <nuno/input.h>
#include <nuno/native.h>
#include <nuno/target_order.h>

#include <algorithm>
#include <cassert>
#include <utility>

namespace nuno {
namespace {

// 1.6 GB of positions, and a file of about 4 GB.
constexpr double most_points_in_frames = 1e8;

// Minutes on native, an hour on box2d, for one rollout: more is a mistake in the scene.
constexpr double most_particle_steps = 1e10;

bool too_long(double steps, const SceneFile& file) {
  return !(steps * static_cast<double>(file.problem.cloth().particles()) <= most_particle_steps);
}

std::unique_ptr<Backend> make_named(std::string_view name, const Problem& problem) {
  const auto& able = engines_for(problem);
  if (std::ranges::find(able, name) == able.end()) {
    throw InputError(fmt::format("{} does not fly a {}; those that do: {}", name,
                                 problem.is_sheet() ? "sheet" : "chain", fmt::join(able, ", ")));
  }
  if (name == "native") return native::make_backend(problem);
  if (name == "bullet") return bullet::make_backend(problem);
  assert(name == "box2d");
  return box2d::make_backend(problem);
}

std::unique_ptr<Backend> make_backend(std::string_view name, const SceneFile& file,
                                      std::optional<double> time_step) {
  const Problem problem = with_time_step(file.problem, time_step);
  const Index particles = problem.cloth().particles();
  if (time_step && too_long(file.scene.arrival_time / *time_step, file)) {
    throw InputError(fmt::format(
        "{}: /time_step: {} is not >= {:.4g}: {} particles over {} s would take too long",
        file.path, *time_step,
        file.scene.arrival_time * static_cast<double>(particles) / most_particle_steps, particles,
        file.scene.arrival_time));
  }
  std::unique_ptr<Backend> backend;
  try {
    backend = make_named(name, problem);
  } catch (const InputError& error) {
    // An engine knows the problem, but not the file that it came from.
    throw InputError(fmt::format("{}: {}", file.path, error.what()));
  }
  if (too_long(static_cast<double>(backend->steps()), file)) {
    throw InputError(
        fmt::format("{}: /{}: {} particles are not few enough: so stiff and fine a cloth takes {} "
                    "steps on {}, which is too long",
                    file.path, problem.is_sheet() ? "initial" : "particles", particles,
                    backend->steps(), name));
  }
  return backend;
}

}  // namespace

SceneFile make_scene_file(const std::string& path, AnyScene scene) {
  const auto* const chain = std::get_if<ChainScene>(&scene);
  Problem problem =
      chain ? make_problem(*chain, path) : make_problem(std::get<SheetInput>(scene).scene, path);
  return {path, scene_of(scene), std::move(problem), std::move(scene)};
}

SceneFile read_scene_file(const std::string& path, const SceneChanges& changes) {
  auto [scene, flight] = read_scene_or_result(path);
  const std::string source = name_of_input(path);
  if (flight && std::ranges::find(backend_names, flight->backend) == backend_names.end()) {
    throw InputError(fmt::format("{}: /backend: \"{}\" is not one of {}", source,
                                 flight->backend.substr(0, 60), fmt::join(backend_names, ", ")));
  }
  if (changes.time_step) {
    const auto replace = [&](auto& of) {
      of.time_step = changes.time_step;
      validate(of, "--time-step");
    };
    if (auto* chain = std::get_if<ChainScene>(&scene)) {
      replace(*chain);
    } else {
      replace(std::get<SheetInput>(scene).scene);
    }
  }
  if (changes.reverses_target) scene = with_reversed_target(std::move(scene), source);
  SceneFile file = make_scene_file(source, std::move(scene));
  file.flight = std::move(flight);
  return file;
}

AnyScene with_reversed_target(AnyScene scene, const std::string& source) {
  auto* const chain = std::get_if<ChainScene>(&scene);
  if (!chain) {
    throw InputError(fmt::format("--reverse-target: is for a chain, and {} is a sheet", source));
  }
  return reversed(std::move(*chain));
}

double frames_per_second_of(double points, const SceneFile& file) {
  return points / static_cast<double>(file.problem.cloth().particles()) / file.scene.arrival_time;
}

void require_few_frames(const SceneFile& file, double more) {
  const double seconds = file.scene.arrival_time + more;
  const double most =
      frames_per_second_of(most_points_in_frames, file) * (file.scene.arrival_time / seconds);
  if (file.scene.frames_per_second > most) {
    throw InputError(fmt::format(
        "{}: /frames_per_second: {} is not <= {:.4g}, the most that a result of {} particles over "
        "{} s holds",
        file.path, file.scene.frames_per_second, most, file.problem.cloth().particles(), seconds));
  }
}

void require_short_tail(const Backend& backend, double tail) {
  const double most =
      most_particle_steps / static_cast<double>(backend.cloth().particles()) * backend.time_step();
  if (tail > most) {
    throw InputError(
        fmt::format("--tail: {} is not <= {:.4g}: {} particles in steps of {:.3g} s "
                    "would take too long",
                    tail, most, backend.cloth().particles(), backend.time_step()));
  }
}

void require_refinable(const SceneFile& file) {
  if (file.problem.is_sheet()) return;  // takes no jacobian
  constexpr Index most = 128;  // a jacobian takes N times as long as a flight, and N² numbers
  const Index particles = file.problem.cloth().particles();
  if (particles <= most) return;
  throw InputError(fmt::format("{}: /particles: {} is not <= {}, the most to refine", file.path,
                               particles, most));
}

void require_groups(const SceneFile& file, Index groups) {
  if (groups <= 1) return;
  const bool is_sheet = file.problem.is_sheet();
  const Index fewest = is_sheet ? fewest_sheet_particles(groups) : fewest_particles(groups);
  const Index particles = file.problem.cloth().particles();
  if (particles >= fewest) return;
  const std::string had = is_sheet ? fmt::format("/initial: {} vertices are", particles)
                                   : fmt::format("/particles: {} is", particles);
  throw InputError(fmt::format("{}: {} not >= {}, the fewest for {} coefficients", file.path, had,
                               fewest, groups));
}

std::unique_ptr<Backend> make_backend(std::string_view name, const SceneFile& file) {
  return make_backend(name, file, file.scene.time_step);
}

MakeBackend backend_maker(std::string_view name, const SceneFile& file) {
  return [name, &file](const Problem& problem) {
    return make_backend(name, {file.path, file.scene, problem});
  };
}

std::unique_ptr<Backend> make_backend_for_gain(std::string_view name, const SceneFile& file,
                                               double gain, std::string_view option) {
  std::unique_ptr<Backend> backend = make_backend(name, file);
  // The largest gain goes with 1/h², and an engine may choose shorter steps than it is asked for.
  double steps = 0;
  while (gain > backend->largest_gain()) {
    steps = 2 * std::max(steps, static_cast<double>(backend->steps()));
    if (too_long(steps, file) || steps > most_steps) {
      throw InputError(
          fmt::format("{}: {} is not <= {:.4g}, the largest gain that {} steps "
                      "on {} resolve; more would take too long",
                      option, gain, backend->largest_gain(), backend->steps(), name));
    }
    backend = make_backend(name, file, file.problem.arrival_time / steps);
  }
  return backend;
}

std::unique_ptr<Backend> at_finer_step(const Backend& backend, const SceneFile& file,
                                       double share) {
  const double steps = static_cast<double>(backend.steps()) / share;
  if (too_long(steps, file) || steps > most_steps) return nullptr;
  // The backend's problem, and not the file's: its reference may be corrected.
  return make_backend(backend.name(), {file.path, file.scene, backend.problem()},
                      backend.time_step() * share);
}

JudgedRollout judged_rollout(const Backend& backend, const SceneFile& file, const Gains& gains,
                             const RolloutOptions& options) {
  JudgedRollout result{.finer = nullptr, .flight = rollout(backend, gains, options)};
  for (const double share : {1.0 / 4, 1.0 / 16}) {
    if (!diverged(result.flight) || file.scene.time_step) break;
    std::unique_ptr<Backend> finer = at_finer_step(backend, file, share);
    if (!finer) break;
    Rollout flight = rollout(*finer, gains, options);
    if (!diverged(flight)) result = {.finer = std::move(finer), .flight = std::move(flight)};
  }
  if (diverged(result.flight)) return result;
  const Backend& flew = result.finer ? *result.finer : backend;
  result.sensitivity = bounded_sensitivity(flew, result.flight);
  if (!has_doubtful_step(result.flight, result.sensitivity)) return result;
  if (const auto half = at_finer_step(flew, file, 0.5)) {
    measure_step(flew.cloth(), rollout(*half, gains), result.flight);
  }
  return result;
}

RefineSummary refine_on(std::string_view name, const SceneFile& file,
                        const RefineOptions& options) {
  const MakeBackend model = backend_maker("native", file);
  const double gain = tracking_gain(*model(file.problem));
  const RefineSummary refined = refine(file.problem, gain, model, model, options);
  return name == "native"
             ? refined
             : transfer(file.problem, refined, backend_maker(name, file), model, options);
}

OptimizeSummary run_optimizer(std::string_view name, const Objective& objective) {
  if (name == "steepest-descent") return steepest_descent(objective);
  assert(name == "global");
  return global_search(objective);
}

}  // namespace nuno
