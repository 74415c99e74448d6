#include <nuno/optimize.h>

#include "derivative_search.h"
#include "gain_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
// Boost 1.74's header needs it and does not include it.
#include <boost/math/tools/minima.hpp>
#include <cstdint>

namespace nuno {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// An objective that counts its rollouts.
class Counter {
 public:
  explicit Counter(const Objective& objective) : objective_(objective) {}

  std::vector<double> errors(std::span<const double> gains) {
    count_ += static_cast<Index>(gains.size());
    return objective_.errors(gains);
  }
  double error(double gain) { return errors({&gain, 1}).front(); }
  Index count() const { return count_; }

 private:
  const Objective& objective_;
  Index count_ = 0;
};

/// dE/dα by central differences, one-sided at α = 0 (second order in δ both times).
double central_difference(Counter& objective, double gain, double error, double delta) {
  if (gain >= delta) {
    const std::array around = {gain - delta, gain + delta};
    const std::vector<double> errors = objective.errors(around);
    return (errors[1] - errors[0]) / (2 * delta);
  }
  const std::array ahead = {gain + delta, gain + 2 * delta};
  const std::vector<double> errors = objective.errors(ahead);
  return (4 * errors[0] - errors[1] - 3 * error) / (2 * delta);
}

}  // namespace

Objective objective(const Backend& backend) {
  Objective result;
  result.errors = [&backend](std::span<const double> gains) { return backend.errors(gains); };
  if (backend.has_derivatives()) {
    result.samples = [&backend](std::span<const double> gains) {
      return backend.error_samples(gains);
    };
  }
  const Problem& problem = backend.problem();
  result.gain_scale = problem.cloth().particle_mass / (problem.arrival_time * problem.arrival_time);
  result.largest_gain = backend.largest_gain();
  result.damping_ratio = problem.damping_ratio;
  result.size = problem.cloth().size;
  result.negligible = 1e-10 * result.size;
  return result;
}

OptimizeSummary steepest_descent(const Objective& objective,
                                 const SteepestDescentOptions& options) {
  const auto start = Clock::now();
  Counter counter(objective);
  OptimizeSummary summary;
  summary.status = OptimizeStatus::budget;
  summary.reason = fmt::format("the budget of {} rollouts ran out", options.largest_evaluations);
  summary.gain = options.first_gain;
  summary.error = counter.error(summary.gain);
  summary.history.push_back({summary.gain, summary.error});

  double lambda = 0;  // of α ← α − λ·dE/dα
  const auto converged = [&](std::string reason) {
    summary.status = OptimizeStatus::converged;
    summary.reason = std::move(reason);
  };
  while (counter.count() < options.largest_evaluations) {
    const double unit = summary.gain + objective.gain_scale;
    const double derivative =
        central_difference(counter, summary.gain, summary.error, options.difference * unit);
    if (!std::isfinite(derivative)) {
      converged("the rollouts beside this gain diverge");
      break;
    }
    if (derivative == 0 || (summary.gain == 0 && derivative > 0)) {
      converged(derivative == 0 ? "the error is level" : "the error rises from gain 0");
      break;
    }
    if (lambda == 0) lambda = options.first_step * objective.gain_scale / std::abs(derivative);

    bool moved = false;
    double move = std::numeric_limits<double>::infinity();
    while (counter.count() < options.largest_evaluations) {
      const double gain =
          std::clamp(summary.gain - lambda * derivative, 0.0, objective.largest_gain);
      move = std::abs(gain - summary.gain);
      if (move <= options.gain_tolerance * unit) break;
      const double error = counter.error(gain);
      // Armijo: a step that falls by a tenth of what the derivative predicts is taken.
      if (error < summary.error - 0.1 * std::abs(derivative) * move) {
        summary.gain = gain;
        summary.error = error;
        summary.history.push_back({gain, error});
        moved = true;
        break;
      }
      lambda *= 0.5;
    }
    if (moved) {
      lambda *= 2;
    } else if (move <= options.gain_tolerance * unit) {
      converged("the next move is shorter than the tolerance");
      break;
    }
  }
  summary.evaluations = counter.count();
  summary.seconds = seconds_since(start);
  return summary;
}

namespace {

/// The gains of a scan up to `largest`: 0, then from the smallest that makes sense evenly spaced in
/// log(1 + φ/6), where φ = √(α/gain scale) is the phase [rad] that control turns through until
/// arrival: E(α) swings with φ, and where control is damped ever less sharply. Where it is not,
/// they end at φ = 10, and others follow `apart` [rad].
std::vector<double> scan_gains(const Objective& objective, const GlobalSearchOptions& options,
                               double largest, Index count, double apart) {
  constexpr double knee = 6;
  const auto place = [](double gain) { return std::log1p(std::sqrt(gain) / knee); };
  const double first = options.smallest_gain;
  const double last = std::max(2 * first, largest / objective.gain_scale);
  const double bend = swings(objective) ? std::min(last, calm_gain_scales) : last;
  std::vector<double> gains = {0};
  for (Index i = 0; i + 2 < count; ++i) {
    const double along = static_cast<double>(i) / static_cast<double>(count - 2);
    const double phase = knee * std::expm1(std::lerp(place(first), place(bend), along));
    gains.push_back(objective.gain_scale * phase * phase);
  }
  gains.push_back(objective.gain_scale * bend);
  // A cubic through samples is off by the fourth power of their distance, and the swings fall by
  // e^(−ζφ).
  const auto next = [&](double phase) {
    return phase + apart * std::exp(0.25 * objective.damping_ratio * phase);
  };
  const double end = std::sqrt(last);
  for (double phase = std::sqrt(bend); phase < end;) {
    phase = std::min(next(phase), end);
    gains.push_back(objective.gain_scale * phase * phase);
  }
  return gains;
}

/// Eight gains about one, a batch: its valley, if little has changed.
std::vector<double> gains_around(const Objective& objective, double gain) {
  std::vector<double> gains;
  for (const double factor : {0.7, 0.8, 0.88, 0.96, 1.04, 1.14, 1.27, 1.45}) {
    gains.push_back(std::min(factor * gain, objective.largest_gain));
  }
  return gains;
}

/// The least error; of errors that are none, that of the least gain.
Evaluation lowest(const OptimizeSummary& summary, double negligible) {
  return *std::ranges::min_element(summary.history, {}, [&](const Evaluation& at) {
    return std::pair(std::max(at.error, negligible), at.gain);
  });
}

/// Is there a valley about the warm start? If the lowest gain is an outermost one, it has moved.
bool search_warm(const Objective& objective, const GlobalSearchOptions& options,
                 OptimizeSummary& summary) {
  const double start = options.warm_start.value_or(0);
  if (!objective.samples || !(start > 0 && start < objective.largest_gain)) return false;
  const std::vector<double> gains = gains_around(objective, start);
  const bool done = search_with_derivatives(objective, gains, options, summary);
  summary.status = done ? OptimizeStatus::converged : OptimizeStatus::budget;
  if (summary.history.empty()) return false;  // all of it is noise
  const double gain = lowest(summary, objective.negligible).gain;
  return gain > gains.front() && gain < gains.back();
}

// ---- refinement by values alone: Brent, one valley after another -----------------------------

void search_by_values(const Objective& objective, std::span<const double> gains,
                      const GlobalSearchOptions& options, OptimizeSummary& summary) {
  Counter counter(objective);
  const std::vector<double> errors = counter.errors(gains);
  for (std::size_t i = 0; i < gains.size(); ++i) summary.history.push_back({gains[i], errors[i]});

  std::vector<std::size_t> valleys;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    const bool below_left = i == 0 || errors[i] <= errors[i - 1];
    const bool below_right = i + 1 == gains.size() || errors[i] <= errors[i + 1];
    if (below_left && below_right && std::isfinite(errors[i])) valleys.push_back(i);
  }
  std::ranges::sort(valleys, {}, [&](std::size_t i) { return errors[i]; });
  if (valleys.size() > static_cast<std::size_t>(options.brackets)) {
    valleys.resize(static_cast<std::size_t>(options.brackets));
  }

  const int bits = static_cast<int>(std::ceil(-std::log2(options.gain_tolerance)));
  for (const std::size_t valley : valleys) {
    auto iterations = static_cast<std::uintmax_t>(options.rounds);
    // In gain scales: Brent's tolerance has a part that is absolute.
    boost::math::tools::brent_find_minima(
        [&](double scales) {
          const double gain = scales * objective.gain_scale;
          const double error = counter.error(gain);
          summary.history.push_back({gain, error});
          return error;
        },
        gains[valley == 0 ? 0 : valley - 1] / objective.gain_scale,
        gains[std::min(valley + 1, gains.size() - 1)] / objective.gain_scale, bits, iterations);
  }
  summary.evaluations += counter.count();
}

}  // namespace

OptimizeSummary global_search(const Objective& objective, const GlobalSearchOptions& options) {
  const auto start = Clock::now();
  OptimizeSummary summary;
  double largest = objective.largest_gain;
  std::string why_largest;
  if (search_warm(objective, options, summary)) {
    summary.reason = "refined the valley of the warm start";
  } else {
    const GainRange range = gain_range(objective, options.largest_gain);
    // Samples tell noise from the rest.
    largest = objective.samples ? range.largest : range.calm;
    why_largest = range.why;
    // Where E swings, derivatives halve the gaps that no cubic sees through: a gain a radian is
    // enough up to φ = 10, one in two radians beyond.
    Index scan = objective.samples ? options.scan : 3 * options.scan;
    if (objective.samples && swings(objective)) scan = std::min<Index>(scan, 10);
    const double apart = objective.samples ? 2.0 : 0.5;
    const std::vector<double> gains = scan_gains(objective, options, largest, scan, apart);
    bool done = true;
    if (objective.samples) {
      done = search_with_derivatives(objective, gains, options, summary);
    } else {
      // Each with its own valleys, so that none of the first is lost to the many beyond.
      const auto first = std::span(gains).first(static_cast<std::size_t>(scan));
      const auto beyond = std::span(gains).subspan(first.size());
      search_by_values(objective, first, options, summary);
      if (!beyond.empty()) search_by_values(objective, beyond, options, summary);
    }
    summary.evaluations += range.evaluations;
    summary.status = done ? OptimizeStatus::converged : OptimizeStatus::budget;
    summary.reason = done
                         ? fmt::format("of {} gains scanned and the valleys between", gains.size())
                         : fmt::format("{} rounds were not enough for all valleys", options.rounds);
  }
  std::ranges::sort(summary.history, {}, &Evaluation::gain);
  const Evaluation best = lowest(summary, objective.negligible);
  summary.gain = best.gain;
  summary.error = best.error;
  // A search by values comes only near an end of its range.
  summary.at_largest_gain = best.error > objective.negligible && best.gain > 0.999 * largest;
  if (summary.at_largest_gain) {
    summary.reason += fmt::format("; the best is the largest gain: {}", why_largest);
  }
  summary.seconds = seconds_since(start);
  return summary;
}

}  // namespace nuno
