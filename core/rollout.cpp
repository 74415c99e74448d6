#include <nuno/rollout.h>

#include <nuno/launch.h>
#include <nuno/reference_motion.h>
#include <nuno/shape_control.h>

#include <Eigen/Geometry>
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
  Recorder(const RolloutOptions& options, double arrival_time, Rollout& rollout)
      : rate_(options.frames_per_second),
        keeps_forces_(options.keeps_forces),
        arrival_time_(arrival_time),
        rollout_(rollout) {}

  /// Before the first step and after every one, with the control forces in it.
  void record(double time, const Simulation& cloth, const Points& forces, bool arrived) {
    if (rate_ <= 0) return;
    for (; due() < arrival_time_ * (1 - 1e-9) && due() <= time; ++frame_) {
      // A step moves at its mean velocity.
      keep(due(), cloth.positions() - (time - due()) * cloth.velocities(), forces);
    }
    if (arrived) keep(arrival_time_, cloth.positions(), forces);
  }

  /// After every step beyond arrival.
  void record_tail(double time, const Simulation& cloth, const Points& forces) {
    if (rate_ <= 0) return;
    for (; due() <= time; ++frame_) {
      if (due() <= arrival_time_ * (1 + 1e-9)) continue;  // kept as the one of arrival
      keep(due(), cloth.positions() - (time - due()) * cloth.velocities(), forces);
    }
  }

 private:
  void keep(double time, Points positions, const Points& forces) {
    rollout_.frame_times.push_back(time);
    rollout_.frame_positions.push_back(std::move(positions));
    if (keeps_forces_) rollout_.frame_forces.push_back(forces);
  }

  double due() const { return static_cast<double>(frame_) / rate_; }

  double rate_;
  bool keeps_forces_;
  double arrival_time_;
  Index frame_ = 0;
  Rollout& rollout_;
};

/// The velocities that the control of a sheet is told. An engine knows those of half a step ago, as
/// the reference does. Both are taken on by half a step, to the time of the positions, so that what
/// the one lacks of the other is 1½ of that of now less ½ of that of a step ago: damping of second
/// order in the step. (A chain's control is told the engine's own, and its damping is of first.)
class VelocityAhead {
 public:
  const Points& of(const Points& velocities, const Points& reference) {
    if (told_.size() == 0) {  // those of the launch are of its own time
      told_ = velocities;
    } else {
      told_ = velocities + 0.5 * ((velocities - before_) - (reference - reference_before_));
    }
    before_ = velocities;
    reference_before_ = reference;
    return told_;
  }

 private:
  Points told_, before_, reference_before_;
};

/// Sums up h²/12 times the change of the acceleration, the local truncation error of Verlet's step
/// (which follows ẍ = a − h²/12·ä). Implicit springs have two to five times as much, with the other
/// sign; what is made of the sum allows for it.
class TruncationError {
 public:
  /// The mean velocities over one step after another.
  void add(const Points& velocities) {
    if (before_.size() > 0) {
      const auto particles = static_cast<double>(velocities.cols());
      if (change_.size() > 0) {
        sum_ += std::sqrt((velocities - before_ - change_).squaredNorm() / particles);
      }
      change_ = velocities - before_;
    }
    before_ = velocities;
  }

  /// [m], of steps of h [s].
  double over_flight(double h) const { return h / 12 * sum_; }

 private:
  Points before_, change_;
  double sum_ = 0;
};

/// Measures the edges of a cloth, which outlives it.
class EdgeMeter {
 public:
  explicit EdgeMeter(const Cloth& cloth)
      : cloth_(cloth), per_square_(cloth.rest_length.array().square().inverse()) {}

  /// Largest |l/ℓ − 1|; NaN if a position is.
  double strain(const Points& x) const {
    Index longest = 0, shortest = 0;
    double most = 0, least = std::numeric_limits<double>::infinity(), sum = 0;
    for_each_square(x, [&](Index e, double square) {
      if (square > most) {
        most = square;
        longest = e;
      }
      if (square < least) {
        least = square;
        shortest = e;
      }
      sum += square;
    });
    if (std::isnan(sum)) return sum;
    const auto strain_of = [&](Index e) {  // a root and a quotient for two edges, not for all
      const double length = (x.col(cloth_.edges(1, e)) - x.col(cloth_.edges(0, e))).norm();
      return std::abs(length / cloth_.rest_length[e] - 1);
    };
    return std::max(strain_of(longest), strain_of(shortest));
  }

  /// Largest difference of the vectors [d × N] at an edge's ends, over ℓ; 0 if one is NaN.
  double spread(const Points& vectors) const {
    double most = 0;
    for_each_square(vectors, [&](Index, double square) { most = std::max(most, square); });
    return std::sqrt(most);
  }

 private:
  /// Calls use(e, |difference at the ends of e|²/ℓ²).
  template <typename Use>
  void for_each_square(const Points& x, const Use& use) const {
    x.rows() == 2 ? for_each_square_in<2>(x, use) : for_each_square_in<3>(x, use);
  }
  template <int dimension, typename Use>
  void for_each_square_in(const Points& x, const Use& use) const {
    assert(x.rows() == dimension);
    for (Index e = 0; e < per_square_.size(); ++e) {
      const double* const a = x.data() + dimension * cloth_.edges(0, e);
      const double* const b = x.data() + dimension * cloth_.edges(1, e);
      double square = 0;
      for (int row = 0; row < dimension; ++row) square += (b[row] - a[row]) * (b[row] - a[row]);
      use(e, square * per_square_[e]);
    }
  }

  const Cloth& cloth_;
  Vector per_square_;  // 1/ℓ²
};

}  // namespace

bool is_torn(const Cloth& cloth, const Points& positions) {
  return !(EdgeMeter(cloth).strain(positions) < torn_strain);
}

double effort_unit(const Problem& problem) {
  const Cloth& cloth = problem.cloth();
  return cloth.particle_mass * (cloth.gravity > 0
                                    ? cloth.gravity
                                    : cloth.size / (problem.arrival_time * problem.arrival_time));
}

Rollout rollout(const Backend& backend, const Gains& gains, const RolloutOptions& options) {
  return rollout(backend, gains, options, backend.cloth().initial);
}

namespace {

void tell_divergence(const Problem& problem, Index step, double strain, const Simulation& cloth,
                     Rollout& result) {
  result.status = RolloutStatus::diverged;
  result.diverged_at_step = step;
  result.reason = cloth.failure();
  if (!result.reason.empty()) return;
  if (!std::isfinite(strain)) {
    result.reason = "a particle's position is no longer finite";
  } else if (problem.is_sheet()) {
    result.reason = "an edge is a thousand times its length";
  } else {
    result.reason = "a segment is a thousand times its length";
  }
}

/// Steps until arrival or divergence, which it tells `result`, as it does the strain on the way.
/// Returns the sum of the squared control forces on particles of mean mass [N²].
double fly(const Backend& backend, const Gains& gains, Simulation& cloth, Recorder& recorder,
           Rollout& result) {
  const Problem& problem = backend.problem();
  const double h = backend.time_step();
  const ShapeControl control(problem, gains, backend.low_modes(gains.count()));
  ReferenceMotion reference(problem, h);
  Points forces = Points::Zero(problem.cloth().dimension(), problem.cloth().particles());
  Points pulls = forces;
  double squared_force = 0;
  const bool looks_ahead = problem.is_sheet() && problem.damping_ratio > 0;
  VelocityAhead ahead;
  TruncationError truncation;
  const EdgeMeter edges(problem.cloth());
  for (Index n = 0; n < backend.steps(); ++n) {
    if (control.pulls()) {
      control.pull(
          reference, cloth.positions(),
          looks_ahead ? ahead.of(cloth.velocities(), reference.velocity()) : cloth.velocities(),
          pulls);
      squared_force += pulls.squaredNorm();
      control.to_forces(pulls, forces);
    }
    if (n == 0) recorder.record(0, cloth, forces, false);
    cloth.step(forces);
    reference.advance();
    const double strain = edges.strain(cloth.positions());
    if (!(strain < torn_strain)) {
      tell_divergence(problem, n + 1, strain, cloth, result);
      break;
    }
    result.max_strain = std::max(result.max_strain, strain);
    result.max_turn = std::max(result.max_turn, h * edges.spread(cloth.velocities()));
    truncation.add(cloth.velocities());
    recorder.record(static_cast<double>(n + 1) * h, cloth, forces, n + 1 == backend.steps());
  }
  result.truncation_error = truncation.over_flight(h) / problem.cloth().size;
  result.final = cloth.positions();
  result.final_velocity = cloth.velocities();
  return squared_force;
}

/// Steps on from arrival without control, for `tail` seconds.
void fly_on(const Backend& backend, double tail, Simulation& cloth, Recorder& recorder,
            Rollout& result) {
  const Problem& problem = backend.problem();
  const double h = backend.time_step();
  const Points no_forces = Points::Zero(problem.cloth().dimension(), problem.cloth().particles());
  const EdgeMeter edges(problem.cloth());
  const auto last = backend.steps() + static_cast<Index>(std::ceil(tail / h * (1 - 1e-9)));
  for (Index n = backend.steps(); n < last; ++n) {
    problem.stop_where_asked();
    cloth.step(no_forces);
    const double strain = edges.strain(cloth.positions());
    if (!(strain < torn_strain)) return tell_divergence(problem, n + 1, strain, cloth, result);
    recorder.record_tail(static_cast<double>(n + 1) * h, cloth, no_forces);
  }
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
  Recorder recorder(options, problem.arrival_time, result);
  const double squared_force = fly(backend, gains, *cloth, recorder, result);
  if (result.status == RolloutStatus::ok) fly_on(backend, options.tail, *cloth, recorder, result);

  if (result.status == RolloutStatus::ok) {
    result.error = arrival_error(problem.cloth(), result.final, problem.target);
    const double samples =
        static_cast<double>(backend.steps()) * static_cast<double>(problem.cloth().particles());
    result.control_effort = std::sqrt(squared_force / samples) / effort_unit(problem);
  } else {
    const double infinity = std::numeric_limits<double>::infinity();
    result.error = {infinity, infinity, infinity};
    result.control_effort = infinity;
  }
  return result;
}

namespace {

/// Phases like those of sin(i²): every wavelength has its share, and no random generator is needed.
double pattern(Index i, unsigned seed) {
  const double k = static_cast<double>(i + 1) + 0.37 * static_cast<double>(seed);
  return std::sin(1.7 * k + 0.61803 * k * k);
}

Points turned(const Chain& chain, double amplitude, unsigned seed) {
  const Points& x = chain.initial;
  Points result(2, x.cols());
  result.col(0).setZero();
  for (Index i = 0; i + 1 < x.cols(); ++i) {
    const double turn = amplitude * pattern(i, seed);
    const double c = std::cos(turn), s = std::sin(turn);
    const Eigen::Vector2d span = x.col(i + 1) - x.col(i);
    result.col(i + 1) =
        result.col(i) + Eigen::Vector2d(c * span.x() - s * span.y(), s * span.x() + c * span.y());
  }
  return shape_of(result).colwise() + centroid(x);
}

Points bulged(const Sheet& sheet, double amplitude, unsigned seed) {
  const Points& x = sheet.initial;
  Points normals = Points::Zero(3, x.cols());
  for (Index t = 0; t < sheet.triangles.cols(); ++t) {
    const auto corners = sheet.triangles.col(t);
    const Eigen::Vector3d a = x.col(corners[0]), b = x.col(corners[1]), c = x.col(corners[2]);
    for (const Index i : corners) normals.col(i) += (b - a).cross(c - a);
  }
  Points result = x;
  for (Index i = 0; i < x.cols(); ++i) {
    result.col(i) += amplitude * sheet.size * pattern(i, seed) * normals.col(i).stableNormalized();
  }
  return sheet.shape_of(result).colwise() + sheet.mass_center(x);
}

}  // namespace

Points perturbed(const Problem& problem, double size, unsigned seed) {
  const auto moved = [&](double amplitude) {
    return problem.is_sheet() ? bulged(problem.sheet(), amplitude, seed)
                              : turned(problem.chain(), amplitude, seed);
  };
  const Cloth& cloth = problem.cloth();
  const double probe = arrival_error(moved(1e-3), cloth.initial).mean / cloth.size;
  return moved(1e-3 * size / probe);
}

namespace {

/// The smallest perturbation, over L, that coordinates so far from the origin tell apart: a
/// thousand times their last digit.
double told_apart(const Problem& problem) {
  const Cloth& cloth = problem.cloth();
  const double farthest =
      std::max(cloth.initial.cwiseAbs().maxCoeff(), problem.target.cwiseAbs().maxCoeff());
  return 1e3 * std::numeric_limits<double>::epsilon() * farthest / cloth.size;
}

}  // namespace

double sensitivity(const Backend& backend, const Rollout& flight) {
  const Problem& problem = backend.problem();
  const Points initial =
      perturbed(problem, std::max(backend.smallest_perturbation(), told_apart(problem)));
  const Rollout twin = rollout(backend, flight.gains, {}, initial);
  if (flight.status == RolloutStatus::diverged || twin.status == RolloutStatus::diverged) {
    return std::numeric_limits<double>::infinity();
  }
  return arrival_error(twin.final, flight.final).mean /
         arrival_error(initial, backend.cloth().initial).mean;
}

}  // namespace nuno
