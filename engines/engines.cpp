#include <nuno/engines.h>
#include <nuno/scene_file.h>

#include <fmt/format.h>

#include <nuno/box2d.h>
#include <nuno/native.h>

#include <algorithm>
#include <cassert>

namespace nuno {
namespace {

// 1.6 GB of positions, and a file of about 4 GB.
constexpr double most_points_in_frames = 1e8;

// Minutes on native, an hour on box2d, for one rollout: more is a mistake in the scene.
constexpr double most_particle_steps = 1e10;

bool too_long(double steps, const SceneFile& file) {
  return !(steps * static_cast<double>(file.scene.particles) <= most_particle_steps);
}

std::unique_ptr<Backend> make_backend(std::string_view name, const SceneFile& file,
                                      std::optional<double> time_step) {
  const Problem problem = with_time_step(file.problem, time_step);
  if (time_step && too_long(file.scene.arrival_time / *time_step, file)) {
    throw InputError(fmt::format(
        "{}: /time_step: {} is not >= {:.4g}: {} particles over {} s would take too long",
        file.path, *time_step,
        file.scene.arrival_time * static_cast<double>(file.scene.particles) / most_particle_steps,
        file.scene.particles, file.scene.arrival_time));
  }
  std::unique_ptr<Backend> backend;
  try {
    if (name == "native") {
      backend = native::make_backend(problem);
    } else {
      assert(name == "box2d");
      backend = box2d::make_backend(problem);
    }
  } catch (const InputError& error) {
    // An engine knows the problem, but not the file that it came from.
    throw InputError(fmt::format("{}: {}", file.path, error.what()));
  }
  if (too_long(static_cast<double>(backend->steps()), file)) {
    throw InputError(
        fmt::format("{}: /particles: {} is not few enough: so stiff and fine a cloth takes {} "
                    "steps on {}, which is too long",
                    file.path, file.scene.particles, backend->steps(), name));
  }
  return backend;
}

SceneFile made_ready(const std::string& path, ChainScene scene) {
  Problem problem = make_problem(scene, path);
  return {path, std::move(scene), std::move(problem)};
}

}  // namespace

SceneFile read_scene_file(const std::string& path, std::optional<double> time_step) {
  ChainScene scene = read_scene(path);
  if (time_step) {
    scene.time_step = time_step;
    validate(scene, "--time-step");
  }
  return made_ready(path, std::move(scene));
}

SceneFile parse_scene_file(const std::string& json, const std::string& path) {
  return made_ready(path, parse_scene(json, path));
}

double frames_per_second_of(double points, const ChainScene& scene) {
  return points / static_cast<double>(scene.particles) / scene.arrival_time;
}

void require_few_frames(const SceneFile& file) {
  const ChainScene& scene = file.scene;
  const double most = frames_per_second_of(most_points_in_frames, scene);
  if (scene.frames_per_second > most) {
    throw InputError(fmt::format(
        "{}: /frames_per_second: {} is not <= {:.4g}, the most that a result of {} particles over "
        "{} s holds",
        file.path, scene.frames_per_second, most, scene.particles, scene.arrival_time));
  }
}

void require_few_particles_to_refine(const SceneFile& file) {
  constexpr Index most = 128;  // a jacobian takes N times as long as a flight, and N² numbers
  if (file.scene.particles <= most) return;
  throw InputError(fmt::format("{}: /particles: {} is not <= {}, the most to refine", file.path,
                               file.scene.particles, most));
}

void require_groups(const SceneFile& file, Index groups) {
  const Index fewest = fewest_particles(groups);
  if (groups > 1 && file.scene.particles < fewest) {
    throw InputError(fmt::format("{}: /particles: {} is not >= {}, the fewest for {} coefficients",
                                 file.path, file.scene.particles, fewest, groups));
  }
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
                                               double gain) {
  std::unique_ptr<Backend> backend = make_backend(name, file);
  // The largest gain goes with 1/h², and an engine may choose shorter steps than it is asked for.
  double steps = 0;
  while (gain > backend->largest_gain()) {
    steps = 2 * std::max(steps, static_cast<double>(backend->steps()));
    if (too_long(steps, file) || steps > most_steps) {
      throw InputError(
          fmt::format("--alpha: {} is not <= {:.4g}, the largest gain that {} steps "
                      "on {} resolve; more would take too long",
                      gain, backend->largest_gain(), backend->steps(), name));
    }
    backend = make_backend(name, file, file.problem.arrival_time / steps);
  }
  return backend;
}

RefineSummary refine_on(std::string_view name, const SceneFile& file, const RefineOptions& options,
                        const std::function<void()>& before_rollout) {
  const auto maker = [&](std::string_view engine) -> MakeBackend {
    return [&, make = backend_maker(engine, file)](const Problem& problem) {
      if (before_rollout) before_rollout();
      return make(problem);
    };
  };
  const MakeBackend model = maker("native");
  const double gain = tracking_gain(*model(file.problem));
  const RefineSummary refined = refine(file.problem, gain, model, model, options);
  return name == "native" ? refined : transfer(file.problem, refined, maker(name), model, options);
}

OptimizeSummary run_optimizer(std::string_view name, const Objective& objective) {
  if (name == "steepest-descent") return steepest_descent(objective);
  assert(name == "global");
  return global_search(objective);
}

}  // namespace nuno
