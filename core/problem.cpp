#include <nuno/problem.h>

#include <cmath>

namespace nuno {

Problem make_problem(const Scene& scene, std::string source) {
  if (source.empty()) source = scene.name.empty() ? "scene" : scene.name;
  validate(scene, source);

  Problem problem;
  problem.arrival_time = scene.arrival_time;
  problem.launch = scene.launch;
  problem.reference = scene.reference;
  problem.arrival = scene.arrival;
  problem.damping_ratio = scene.damping_ratio;

  Chain& chain = problem.chain;
  const auto particles = static_cast<double>(scene.particles);
  chain.initial = resample(scene.initial, scene.particles);
  chain.rest_length = segment_lengths(chain.initial);
  chain.hinge_length = 0.5 * (chain.rest_length.head(scene.particles - 2) +
                              chain.rest_length.tail(scene.particles - 2));
  chain.length = chain.rest_length.sum();
  chain.particle_mass = scene.cloth.mass / particles;
  chain.particle_drag = scene.cloth.air_drag / particles;
  chain.gravity = scene.gravity;
  chain.cloth = scene.cloth;
  // A drawing that runs back over itself can put two neighbours on one spot: no segment is there.
  if (!(chain.rest_length.minCoeff() > 1e-9 * chain.length)) {
    throw InputError(
        source + ": /initial: the line resampled to /particles points has a segment of no length");
  }

  problem.target = resample(scene.target, scene.particles);
  if (scene.target_length == TargetLength::fit) {
    const double drawn = segment_lengths(problem.target).sum();
    if (!(drawn > 1e-9 * chain.length)) {
      throw InputError(source +
                       ": /target: the line resampled to /particles points has no length to fit");
    }
    problem.target_scale = chain.length / drawn;
    const Vector center = centroid(problem.target);
    problem.target =
        (problem.target_scale * (problem.target.colwise() - center)).colwise() + center;
  }
  return problem;
}

}  // namespace nuno
