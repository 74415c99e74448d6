#include <nuno/problem.h>

#include <cmath>

namespace nuno {
namespace {

/// What every form of cloth is thrown by.
Problem problem_of(const Scene& scene) {
  Problem problem;
  problem.arrival_time = scene.arrival_time;
  problem.launch = scene.launch;
  problem.reference = scene.reference;
  problem.arrival = scene.arrival;
  problem.damping_ratio = scene.damping_ratio;
  problem.time_step = scene.time_step;
  return problem;
}

std::string source_of(const Scene& scene, std::string source) {
  if (!source.empty()) return source;
  return scene.name.empty() ? "scene" : scene.name;
}

/// The target scaled about its centre.
Points scaled(const Points& target, double scale, const Vector& center) {
  return (scale * (target.colwise() - center)).colwise() + center;
}

}  // namespace

Problem make_problem(const ChainScene& scene, std::string source) {
  source = source_of(scene, std::move(source));
  validate(scene, source);

  Problem problem = problem_of(scene);
  const Chain chain =
      make_chain(resample(scene.initial, scene.particles), scene.cloth, scene.gravity);
  // A drawing that runs back over itself can put two neighbours on one spot: no segment is there.
  if (!(chain.rest_length.minCoeff() > 1e-9 * chain.size)) {
    throw InputError(
        source + ": /initial: the line resampled to /particles points has a segment of no length");
  }

  const bool is_reversed = scene.target_order == TargetOrder::reversed;
  problem.target =
      resample(is_reversed ? scene.target.rowwise().reverse() : scene.target, scene.particles);
  if (scene.target_length == TargetLength::fit) {
    const double drawn = segment_lengths(problem.target).sum();
    if (!(drawn > 1e-9 * chain.size)) {
      throw InputError(source +
                       ": /target: the line resampled to /particles points has no length to fit");
    }
    problem.target_scale = chain.size / drawn;
    problem.target = scaled(problem.target, problem.target_scale, centroid(problem.target));
  }
  problem.form = chain;
  return problem;
}

Problem make_problem(const SheetScene& scene, std::string source) {
  source = source_of(scene, std::move(source));
  validate(scene, source);

  Problem problem = problem_of(scene);
  const Sheet sheet =
      make_sheet(scene.initial, scene.faces, scene.cloth, scene.rest, scene.gravity);
  problem.target = scene.target;
  if (scene.target_length == TargetLength::fit) {
    const double drawn = std::sqrt(area(scene.target, scene.faces));
    if (!(drawn > 1e-9 * sheet.size)) {
      throw InputError(source + ": /target: the mesh has no area to fit");
    }
    problem.target_scale = sheet.size / drawn;
    problem.target =
        scaled(problem.target, problem.target_scale, sheet.mass_center(problem.target));
  }
  problem.form = sheet;
  return problem;
}

Problem with_time_step(Problem problem, std::optional<double> time_step) {
  problem.time_step = time_step;
  return problem;
}

}  // namespace nuno
