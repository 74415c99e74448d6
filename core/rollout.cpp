#include <nuno/rollout.h>

#include <nuno/launch.h>
#include <nuno/reference_motion.h>
#include <nuno/shape_control.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace nuno {
namespace {

constexpr double torn_strain = 1000;

/// Keeps the frames of a flight, interpolated between the two steps around each frame's time.
class Recorder {
 public:
  Recorder(double frames_per_second, double arrival_time, Rollout& rollout)
      : rate_(frames_per_second), arrival_time_(arrival_time), rollout_(rollout) {}

  /// After every step, and before the first.
  void record(double time, const Simulation& cloth, bool arrived) {
    if (rate_ <= 0) return;
    for (; due() < arrival_time_ * (1 - 1e-9) && due() <= time; ++frame_) {
      // A step moves at its mean velocity.
      keep(due(), cloth.positions() - (time - due()) * cloth.velocities());
    }
    if (arrived) keep(arrival_time_, cloth.positions());
  }

 private:
  void keep(double time, Points positions) {
    rollout_.frame_times.push_back(time);
    rollout_.frame_positions.push_back(std::move(positions));
  }

  double due() const { return static_cast<double>(frame_) / rate_; }

  double rate_;
  double arrival_time_;
  Index frame_ = 0;
  Rollout& rollout_;
};

/// Largest |l/ℓ − 1| of the segments; NaN if a position is.
double largest_strain(const Chain& chain, const Points& x) {
  double largest = 0;
  for (Index i = 0; i < chain.rest_length.size(); ++i) {
    const double dx = x(0, i + 1) - x(0, i);
    const double dy = x(1, i + 1) - x(1, i);
    const double strain = std::abs(std::sqrt(dx * dx + dy * dy) / chain.rest_length[i] - 1);
    if (std::isnan(strain)) return strain;
    largest = std::max(largest, strain);
  }
  return largest;
}

}  // namespace

bool is_torn(const Chain& chain, const Points& positions) {
  return !(largest_strain(chain, positions) < torn_strain);
}

double effort_unit(const Problem& problem) {
  const Chain& chain = problem.chain;
  return chain.particle_mass * (chain.gravity > 0
                                    ? chain.gravity
                                    : chain.length / (problem.arrival_time * problem.arrival_time));
}

Rollout rollout(const Backend& backend, const Gains& gains, const RolloutOptions& options) {
  return rollout(backend, gains, options, backend.problem().chain.initial);
}

namespace {

/// Steps until arrival or divergence, which it tells `result`, as it does the strain on the way.
/// Returns the sum of the squared control forces [N²].
double fly(const Backend& backend, const Gains& gains, Simulation& cloth, Recorder& recorder,
           Rollout& result) {
  const Problem& problem = backend.problem();
  const double h = backend.time_step();
  const ShapeControl control(problem, gains);
  ReferenceMotion reference(problem, h);
  Points forces = Points::Zero(2, problem.chain.particles());
  double squared_force = 0;
  recorder.record(0, cloth, false);
  for (Index n = 0; n < backend.steps(); ++n) {
    if (control.pulls()) {
      control.pull(reference, cloth.positions(), cloth.velocities(), forces);
      squared_force += forces.squaredNorm();
    }
    cloth.step(forces);
    reference.advance();
    const double strain = largest_strain(problem.chain, cloth.positions());
    if (!(strain < torn_strain)) {
      result.status = RolloutStatus::diverged;
      result.diverged_at_step = n + 1;
      result.reason = cloth.failure();
      if (result.reason.empty()) {
        result.reason = std::isfinite(strain) ? "a segment is a thousand times its length"
                                              : "a particle's position is no longer finite";
      }
      break;
    }
    result.max_strain = std::max(result.max_strain, strain);
    recorder.record(static_cast<double>(n + 1) * h, cloth, n + 1 == backend.steps());
  }
  return squared_force;
}

}  // namespace

Rollout rollout(const Backend& backend, const Gains& gains, const RolloutOptions& options,
                const Points& initial) {
  assert(std::ranges::min(gains.groups()) >= 0);
  const Problem& problem = backend.problem();
  Rollout result;
  result.gains = gains;
  result.launch_velocity = launch(backend);
  const std::unique_ptr<Simulation> cloth = backend.start(initial, result.launch_velocity);
  Recorder recorder(options.frames_per_second, problem.arrival_time, result);
  const double squared_force = fly(backend, gains, *cloth, recorder, result);

  result.final = cloth->positions();
  if (result.status == RolloutStatus::ok) {
    result.error = arrival_error(result.final, problem.target);
    const double samples =
        static_cast<double>(backend.steps()) * static_cast<double>(problem.chain.particles());
    result.control_effort = std::sqrt(squared_force / samples) / effort_unit(problem);
  } else {
    const double infinity = std::numeric_limits<double>::infinity();
    result.error = {infinity, infinity, infinity};
    result.control_effort = infinity;
  }
  return result;
}

Points disturbed(const Chain& chain, double size, unsigned seed) {
  const Points& x = chain.initial;
  // Turns of sin(i²)-like phases: every wavelength has its share, and no random generator is
  // needed.
  const auto turned = [&](double amplitude) {
    Points result(2, x.cols());
    result.col(0).setZero();
    for (Index i = 0; i + 1 < x.cols(); ++i) {
      const double k = static_cast<double>(i + 1) + 0.37 * static_cast<double>(seed);
      const double turn = amplitude * std::sin(1.7 * k + 0.61803 * k * k);
      const double c = std::cos(turn), s = std::sin(turn);
      const Eigen::Vector2d span = x.col(i + 1) - x.col(i);
      result.col(i + 1) =
          result.col(i) + Eigen::Vector2d(c * span.x() - s * span.y(), s * span.x() + c * span.y());
    }
    return Points(shape_of(result).colwise() + centroid(x));
  };
  const double probe = arrival_error(turned(1e-3), x).mean / chain.length;
  return turned(1e-3 * size / probe);
}

double sensitivity(const Backend& backend, const Rollout& flight) {
  const Chain& chain = backend.problem().chain;
  const Points initial = disturbed(chain, backend.smallest_disturbance());
  const Rollout twin = rollout(backend, flight.gains, {}, initial);
  if (flight.status == RolloutStatus::diverged || twin.status == RolloutStatus::diverged) {
    return std::numeric_limits<double>::infinity();
  }
  return arrival_error(twin.final, flight.final).mean / arrival_error(initial, chain.initial).mean;
}

}  // namespace nuno
