#include <nuno/refine.h>

#include <nuno/feasibility.h>
#include <nuno/optimize.h>
#include <nuno/reference_motion.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "gain_range.h"
#include "refinement.h"
#include "trust_region.h"

namespace nuno {
namespace {

/// Shapes to correct the reference by: cosines along the chain, of few waves where they come early
/// and must not stretch the cloth on its way, and all of them at the last, where it has to arrive.
CorrectionDirections correction_directions(Index particles) {
  constexpr std::array<Index, correction_powers.size()> most_waves = {8, 8, 16, 1'000'000};
  CorrectionDirections directions;
  std::vector<Vector> shapes;
  for (std::size_t power = 0; power < correction_powers.size(); ++power) {
    for (Index wave = 1; wave <= std::min(most_waves[power], particles - 1); ++wave) {
      for (const Index row : {0, 1}) {
        Points shape = Points::Zero(2, particles);
        for (Index i = 0; i < particles; ++i) {
          shape(row, i) = std::cos(std::numbers::pi * static_cast<double>(wave) *
                                   (static_cast<double>(i) + 0.5) / static_cast<double>(particles));
        }
        directions.powers.push_back(static_cast<Index>(power));
        shapes.emplace_back(shape.reshaped());
      }
    }
  }
  directions.shapes.resize(2 * particles, static_cast<Index>(shapes.size()));
  for (std::size_t d = 0; d < shapes.size(); ++d) {
    directions.shapes.col(static_cast<Index>(d)) = shapes[d];
  }
  return directions;
}

std::vector<Points> moved(std::vector<Points> offset, const CorrectionDirections& directions,
                          const Vector& step) {
  for (Index d = 0; d < step.size(); ++d) {
    Points& of_power =
        offset[static_cast<std::size_t>(directions.powers[static_cast<std::size_t>(d)])];
    of_power += step[d] * directions.shapes.col(d).reshaped(2, of_power.cols());
  }
  return offset;
}

/// Homotopy from a flight in which effort counts to one that arrives: the weight of the error in
/// effort² + weight²·error² grows with every step that succeeds.
class Homotopy {
 public:
  Homotopy(double weight, double largest_weight)
      : weight_(weight), largest_weight_(largest_weight) {}

  double weight() const { return weight_; }
  bool is_over() const { return weight_ > largest_weight_; }
  void advance() { weight_ *= growth_; }

  /// Takes the last advance back and goes on by a smaller one; false if that is not worth a flight.
  bool advance_less() {
    if (growth_ < 1.05) return false;
    weight_ /= growth_;
    growth_ = std::sqrt(growth_);
    weight_ *= growth_;
    return true;
  }

 private:
  double weight_, largest_weight_;
  double growth_ = 4;
};

/// The last correction: where the Jacobian no longer foretells what effort can be spared, little of
/// it is left to spare; from near enough, the rest of the error alone is removed.
struct Landing {
  double near_enough;      ///< mean distance from which to land [m]
  bool is_active = false;  ///< the steps are of a landing
  double stride = 1;       ///< part of the way that one step goes, at least least_stride

  static constexpr double least_stride = 1e-2;

  void lengthen() { stride = std::min(1.0, 4 * stride); }

  /// From `error`, no step came nearer: lands again once it is much nearer.
  void give_up(double error) {
    is_active = false;
    near_enough = 0.3 * error;
  }
};

/// Whether the rounds go on.
enum class Next { round, stop };

/// A refinement on its way: the best flight up to now, and what the next round needs to know.
class Refinement {
 public:
  Refinement(const Problem& problem, double gain, const MakeBackend& make, const MakeBackend& model,
             const RefineOptions& options)
      : problem_(problem),
        gain_(gain),
        make_(make),
        make_model_(model),
        options_(options),
        length_(problem.cloth().size),
        unit_(1 / (length_ * std::sqrt(static_cast<double>(problem.cloth().particles())))),
        directions_(correction_directions(problem.cloth().particles())),
        summary_(first_flight(problem, gain, make, options)),
        within_reach_(is_within_reach(problem, make)),
        homotopy_(first_weight(), largest_weight()),
        landing_{has_limit() || !within_reach_ ? 0 : 1e-3 * length_} {}

  RefineSummary run() {
    for (Index i = 0; i < options_.rounds && !is_over(); ++i) {
      if (next_round() == Next::stop) break;
    }
    conclude(summary_, options_.tolerance * length_, options_.effort_limit);
    return std::move(summary_);
  }

 private:
  /// A step of the correction, and the flight that it leads to.
  struct Trial {
    Vector step;
    std::vector<Points> correction;
    Rollout flight;
  };

  bool has_limit() const { return std::isfinite(options_.effort_limit); }
  bool is_within_limit(const Rollout& flight) const {
    return flight.control_effort <= options_.effort_limit;
  }

  Vector residual(const Rollout& flight) const {
    return (problem_.target - flight.final).reshaped();
  }

  double objective(const Rollout& flight) const {
    return flight.control_effort * flight.control_effort +
           std::pow(homotopy_.weight() * unit_, 2) * residual(flight).squaredNorm();
  }

  Problem corrected(const std::vector<Points>& correction) const {
    Problem corrected = problem_;
    corrected.reference_correction = correction;
    return corrected;
  }

  /// An answer of before is corrected where it stands; a new one starts where effort counts.
  double first_weight() const {
    const double here = summary_.flight.control_effort * length_ / summary_.flight.error.mean;
    if (!problem_.reference_correction.empty()) return here;
    return std::min(here, has_limit() ? 1.0 : 30.0);
  }

  double largest_weight() const {
    return within_reach_ || has_limit() ? std::numeric_limits<double>::infinity() : worth_of_error;
  }

  Next stop(const char* reason) {
    summary_.reason = reason;
    return Next::stop;
  }

  /// Arrived, or nothing more can come of it.
  bool is_over() {
    if (summary_.flight.error.mean <= options_.tolerance * length_) return true;
    if (summary_.flight.status == RolloutStatus::diverged) {
      stop("the flight diverged");
      return true;
    }
    if (homotopy_.is_over()) {
      stop("the cloth's segments do not fit the target's; this is as near as is worth it");
      return true;
    }
    return false;
  }

  Next next_round() {
    if (!trust_.has_model()) {
      ++summary_.jacobians;
      if (!trust_.set_model(make_model_(corrected(summary_.reference_correction))
                                ->jacobian(gain_, directions_))) {
        return stop("the jacobian is not finite");
      }
    }
    return landing_.is_active ? land() : gauss_newton();
  }

  Trial fly(Vector step) {
    std::vector<Points> correction = moved(summary_.reference_correction, directions_, step);
    Rollout flight = rollout(*make_(corrected(correction)), gain_);
    ++summary_.rollouts;
    return {std::move(step), std::move(correction), std::move(flight)};
  }

  void accept(Trial trial) {
    trust_.model().go(trial.step);
    summary_.flight = std::move(trial.flight);
    summary_.reference_correction = std::move(trial.correction);
  }

  Next land() {
    Trial trial = fly(landing_.stride * trust_.model().landing(residual(summary_.flight)));
    const double left = trial.flight.error.mean / summary_.flight.error.mean;
    const bool nearer = left < 1 - 0.3 * landing_.stride;
    const bool fresh = trust_.model().is_fresh();
    if (nearer) accept(std::move(trial));
    if (left < 0.25) return Next::round;
    if (nearer || !fresh) {
      trust_.drop_model();
      landing_.lengthen();
    } else if (landing_.stride > Landing::least_stride) {
      landing_.stride /= 4;
    } else {
      landing_.give_up(summary_.flight.error.mean);
    }
    return Next::round;
  }

  Next gauss_newton() {
    const double weight = homotopy_.weight() * unit_;
    const Vector left = residual(summary_.flight);
    Trial trial = fly(trust_.model().step(left, weight));
    const double kept = (objective(summary_.flight) - objective(trial.flight)) /
                        trust_.model().predicted_reduction(left, weight, trial.step);
    return kept > 0.1 ? advance(std::move(trial), kept) : retry();
  }

  /// After a step that kept such a part of the reduction that the model predicted.
  Next advance(Trial trial, double kept) {
    const bool was_within_limit = is_within_limit(summary_.flight);
    if (was_within_limit && trial.flight.control_effort > options_.effort_limit) {
      return homotopy_.advance_less() ? Next::round : stop(no_more_effort);
    }
    accept(std::move(trial));
    if (was_within_limit || is_within_limit(summary_.flight)) homotopy_.advance();
    if (kept < 0.5) {
      trust_.drop_model();
    } else {
      trust_.widen();
    }
    return Next::round;
  }

  /// After a step that the model did not foretell: lands from here, or prepares a better step.
  Next retry() {
    if (summary_.flight.error.mean < landing_.near_enough) {
      landing_.is_active = true;
      trust_.prepare_landing();
    } else if (!trust_.model().is_fresh()) {
      trust_.drop_model();
    } else if (!trust_.narrow()) {
      return stop("no offset brings it nearer");
    }
    return Next::round;
  }

  const Problem& problem_;
  const double gain_;
  const MakeBackend& make_;
  const MakeBackend& make_model_;
  const RefineOptions& options_;
  const double length_;  // L
  const double unit_;    // 1/(L·√N): an rms error of L counts as much as an effort of the weight
  const CorrectionDirections directions_;

  RefineSummary summary_;
  const bool within_reach_;
  Homotopy homotopy_;
  TrustRegion trust_;
  Landing landing_;
};

}  // namespace

RefineSummary first_flight(const Problem& problem, double gain, const MakeBackend& make,
                           const RefineOptions& options) {
  const Cloth& cloth = problem.cloth();
  Problem corrected = problem;
  if (corrected.reference_correction.empty()) {
    corrected.reference_correction.assign(correction_powers.size(),
                                          Points::Zero(cloth.dimension(), cloth.particles()));
  }
  RefineSummary summary;
  summary.reference_correction = corrected.reference_correction;
  summary.flight = rollout(*make(corrected), gain);
  summary.rollouts = 1;
  summary.error_before = summary.flight.error.mean;
  summary.reason = fmt::format("{} rounds were not enough", options.rounds);
  return summary;
}

bool is_within_reach(const Problem& problem, const MakeBackend& make) {
  constexpr double reachable_mismatch = 1e-6;
  return assess(*make(problem)).length_mismatch <= reachable_mismatch;
}

void conclude(RefineSummary& summary, double tolerance, double effort_limit) {
  summary.converged = summary.flight.error.mean <= tolerance;
  if (summary.converged) summary.reason = arrived;
  if (summary.flight.control_effort > effort_limit) {
    summary.converged = false;
    summary.reason = too_much_effort;
  }
}

double tracking_gain(const Backend& backend) {
  // √300 = 17 rad until arrival: what the launch leaves behind has died away by then, and nothing
  // that the engines see differently grows. Without damping, nothing does up to 10 rad.
  const Objective range = objective(backend);
  const double gain_scales = swings(range) ? calm_gain_scales : 300;
  return std::min(gain_scales * range.gain_scale, range.largest_gain);
}

RefineSummary refine(const Problem& problem, double gain, const MakeBackend& make,
                     const MakeBackend& model, const RefineOptions& options) {
  const Stopwatch stopwatch;
  RefineSummary summary = problem.is_sheet()
                              ? refine_sheet(problem, gain, make, options)
                              : Refinement(problem, gain, make, model, options).run();
  summary.seconds = stopwatch.seconds();
  return summary;
}

RefineSummary transfer(const Problem& problem, const RefineSummary& answer, const MakeBackend& make,
                       const MakeBackend& model, const RefineOptions& options) {
  constexpr double single_precision = 1e-5;
  constexpr Index rounds = 4;
  const Stopwatch stopwatch;
  const double tolerance = std::max(options.tolerance, single_precision);
  const double gain = answer.flight.gains.rest;
  Problem corrected = problem;
  corrected.reference_correction = answer.reference_correction;
  RefineSummary transferred = answer;
  transferred.flight = rollout(*make(corrected), gain);
  transferred.error_before = rollout(*make(problem), gain).error.mean;
  transferred.rollouts += 2;
  transferred.converged = transferred.flight.error.mean <= tolerance * problem.cloth().size;
  if (transferred.converged) {
    transferred.reason = arrived;
  } else if (std::isfinite(options.effort_limit)) {
    // Steps towards the target would leave the Pareto front that the limit asked for.
    transferred.reason = "the limit's point of the Pareto front, as it was found";
  } else {
    const RefineSummary nearer =
        refine(corrected, gain, make, model, {.tolerance = tolerance, .rounds = rounds});
    transferred.rollouts += nearer.rollouts;
    transferred.jacobians += nearer.jacobians;
    if (nearer.flight.error.mean < transferred.flight.error.mean) {
      transferred.flight = nearer.flight;
      transferred.reference_correction = nearer.reference_correction;
      transferred.converged = nearer.converged;
    }
    transferred.reason = nearer.reason;
  }
  if (transferred.flight.control_effort > options.effort_limit) {
    transferred.converged = false;
    transferred.reason = too_much_effort;
  }
  transferred.seconds += stopwatch.seconds();
  return transferred;
}

}  // namespace nuno
