#include "comparison.h"

#include <nuno/optimize.h>

#include <algorithm>
#include <cmath>

#include "rollouts.h"

namespace nuno {
namespace {

constexpr int points_of_curve = 64;

/// 0 and log-spaced gains over the range in which a global search looks and both engines resolve.
std::vector<double> gains_of_curve(const Backend& first, const Backend& second) {
  const GlobalSearchOptions range;
  const double scale = objective(first).gain_scale;
  const double low = range.smallest_gain * scale;
  const double high = std::max(
      2 * low, std::min(objective(first).largest_gain, objective(second).largest_gain));
  std::vector<double> gains = {0};
  for (int i = 0; i < points_of_curve; ++i) {
    gains.push_back(low * std::pow(high / low, i / (points_of_curve - 1.0)));
  }
  return gains;
}

}  // namespace

Comparison compare_engines(const std::string& scene, const Backend& first, const Backend& second) {
  const std::array<const Backend*, 2> engines = {&first, &second};
  Comparison result;
  result.scene = scene;
  result.cloth_length = first.problem().chain.length;

  // A rollout that has to arrive; the first that does not ends the comparison.
  const auto fly = [&](std::size_t engine, double gain) {
    Rollout flight = rollout(*engines[engine], gain);
    if (diverged(flight) && !result.divergence) {
      result.divergence = {std::string(engines[engine]->name()), flight};
    }
    return flight;
  };

  std::array<Rollout, 2> best;
  for (std::size_t i = 0; i < 2; ++i) {
    ComparisonRow& row = result.rows[i];
    row.backend = engines[i]->name();
    row.launch_only_error = fly(i, 0).error.mean;
    if (result.divergence) return result;
    const OptimizeSummary found =
        global_search(with_progress(objective(*engines[i]), scene + " on " + row.backend));
    best[i] = fly(i, found.gain);
    if (result.divergence) return result;
    row.gain = found.gain;
    row.error = best[i].error;
    row.control_effort = best[i].control_effort;
    row.evaluations = found.evaluations;
    row.seconds = found.seconds;
  }

  const Rollout first_with_other = fly(0, best[1].gain);
  const Rollout second_with_other = fly(1, best[0].gain);
  if (result.divergence) return result;
  result.rows[0].error_with_the_other_gain = first_with_other.error.mean;
  result.rows[1].error_with_the_other_gain = second_with_other.error.mean;
  result.shape_difference = shape_difference(best[0].final, second_with_other.final);
  result.shape_difference.mean /= result.cloth_length;
  result.shape_difference.max /= result.cloth_length;

  result.curve_gains = gains_of_curve(first, second);
  for (std::size_t i = 0; i < 2; ++i) {
    result.curve_errors[i] = engines[i]->errors(result.curve_gains);
  }
  return result;
}

}  // namespace nuno
