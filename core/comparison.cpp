#include <nuno/comparison.h>

#include <nuno/conditioning.h>
#include <nuno/parallel.h>

#include "gain_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nuno {
namespace {

constexpr int points_of_curve = 64;

/// What both engines are asked [gain scales]. Without damping E(α) is calm up to 100; beyond, its
/// best valleys are so narrow that one engine's are not the other's.
double largest_compared(const Objective& objective) {
  return swings(objective) ? calm_gain_scales : GlobalSearchOptions().largest_gain;
}

/// 0 and log-spaced gains over the range that is compared and both engines resolve.
std::vector<double> gains_of_curve(const Backend& first, const Backend& second) {
  const Objective range = objective(first);
  const double low = GlobalSearchOptions().smallest_gain * range.gain_scale;
  const double resolved = std::min(range.largest_gain, objective(second).largest_gain);
  const double high = std::max(
      2 * low, swings(range) ? std::min(resolved, calm_gain_scales * range.gain_scale) : resolved);
  std::vector<double> gains = {0};
  for (int i = 0; i < points_of_curve; ++i) {
    gains.push_back(low * std::pow(high / low, i / (points_of_curve - 1.0)));
  }
  return gains;
}

/// The curves over the gain, of both engines.
void fly_curves(const std::array<const Backend*, 2>& engines, const ComparisonOptions& options,
                Comparison& result) {
  result.curve_gains = gains_of_curve(*engines[0], *engines[1]);
  const std::size_t points = result.curve_gains.size();
  const std::vector<double> unknown(points, std::numeric_limits<double>::infinity());
  result.curve_sensitivity = result.curve_strain = unknown;
  for (std::size_t engine = 0; engine < 2; ++engine) {
    result.curve_errors[engine] = result.curve_efforts[engine] = unknown;
    parallel_for(static_cast<Index>(points), [&](Index k) {
      const auto i = static_cast<std::size_t>(k);
      options.before_rollout();
      const Rollout flight = rollout(*engines[engine], result.curve_gains[i]);
      if (diverged(flight)) return;
      result.curve_errors[engine][i] = flight.error.mean;
      result.curve_efforts[engine][i] = flight.control_effort;
      if (engine > 0) return;
      options.before_rollout();
      result.curve_sensitivity[i] = bounded_sensitivity(*engines[0], flight);
      result.curve_strain[i] = flight.max_strain;
    });
  }
}

}  // namespace

Comparison compare_engines(const std::string& scene, const Backend& first, const Backend& second,
                           const ComparisonOptions& options) {
  const std::array<const Backend*, 2> engines = {&first, &second};
  Comparison result;
  result.scene = scene;
  result.cloth_length = first.problem().cloth().size;
  result.launch = first.problem().launch;

  // A rollout that has to arrive; the first that does not ends the comparison.
  const auto fly = [&](std::size_t engine, double gain) {
    options.before_rollout();
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
    const Objective errors = options.objective_of(*engines[i]);
    const OptimizeSummary found = global_search(errors, {.largest_gain = largest_compared(errors)});
    best[i] = fly(i, found.gain);
    if (result.divergence) return result;
    row.gain = found.gain;
    row.error = best[i].error;
    row.control_effort = best[i].control_effort;
    row.max_strain = best[i].max_strain;
    options.before_rollout();
    row.sensitivity = bounded_sensitivity(*engines[i], best[i]);
    row.evaluations = found.evaluations;
    row.seconds = found.seconds;
  }

  const Rollout first_with_other = fly(0, result.rows[1].gain);
  const Rollout second_with_other = fly(1, result.rows[0].gain);
  if (result.divergence) return result;
  result.rows[0].error_with_the_other_gain = first_with_other.error.mean;
  result.rows[1].error_with_the_other_gain = second_with_other.error.mean;
  result.shape_difference = shape_difference(best[0].final, second_with_other.final);
  result.shape_difference.mean /= result.cloth_length;
  result.shape_difference.max /= result.cloth_length;

  fly_curves(engines, options, result);
  return result;
}

namespace {

bool is_calm(double sensitivity, double strain) {
  return sensitivity <= largest_calm_sensitivity && strain <= largest_calm_strain;
}

}  // namespace

bool is_well_conditioned(const Comparison& comparison) {
  return is_calm(comparison.rows[0].sensitivity, comparison.rows[0].max_strain);
}

std::string centroid_warning(const Comparison& comparison) {
  constexpr double largest = 1e-3;  // of L; engines in single precision are within 1e-4
  std::string words;
  for (const ComparisonRow& row : comparison.rows) {
    const double off = row.error.centroid / comparison.cloth_length;
    if (off <= largest) continue;
    words += fmt::format("{}{}'s centroid is {:.2g} % of L from the target's",
                         words.empty() ? "" : ", ", row.backend, 100 * off);
  }
  return words;
}

Spread spread(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(values.size() - 1)))];
  };
  return {at(0.5), at(0.95), values.back()};
}

ComparisonSummary summarize(const std::vector<Comparison>& comparisons) {
  ComparisonSummary summary;
  std::vector<double> gaps, losses;
  std::size_t agreeing = 0;
  for (const Comparison& comparison : comparisons) {
    ++summary.scenes;
    if (!is_well_conditioned(comparison)) continue;
    ++summary.well_conditioned;
    if (comparison.launch != Launch::inextensible) continue;
    ++summary.judged;
    gaps.push_back(comparison.shape_difference.mean);
    for (const ComparisonRow& row : comparison.rows) {
      losses.push_back(row.error_with_the_other_gain / row.error.mean - 1);
    }
    for (std::size_t i = 0; i < comparison.curve_gains.size(); ++i) {
      if (!is_calm(comparison.curve_sensitivity[i], comparison.curve_strain[i])) continue;
      const double error = comparison.curve_errors[0][i];
      const double difference = std::abs(comparison.curve_errors[1][i] - error);
      ++summary.curve_points;
      if (difference <= std::max(0.02 * error, 1e-3 * comparison.cloth_length)) ++agreeing;
    }
  }
  summary.gap = spread(std::move(gaps));
  summary.loss = spread(std::move(losses));
  if (summary.curve_points > 0) {
    summary.curve_agreement =
        static_cast<double>(agreeing) / static_cast<double>(summary.curve_points);
  }
  return summary;
}

}  // namespace nuno
