#pragma once

#include <nuno/backend.h>
#include <nuno/error.h>
#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nuno {

/// What one engine made of a scene; errors in metres.
struct ComparisonRow {
  std::string backend;
  double launch_only_error = 0;
  double gain = 0;  ///< the best α [N/m]
  ArrivalError error;
  double control_effort = 0;
  double max_strain = 0;   ///< on the way
  double sensitivity = 0;  ///< see bounded_sensitivity
  Index evaluations = 0;
  double seconds = 0;                    ///< of the search, wall clock
  double error_with_the_other_gain = 0;  ///< E at the other engine's best α
};

/// A rollout that a comparison needs and that diverged.
struct Divergence {
  std::string backend;
  Rollout rollout;
};

/// Two engines on one problem.
struct Comparison {
  std::string scene;
  double cloth_length = 0;  ///< L [m]
  Launch launch = Launch::ballistic;
  std::array<ComparisonRow, 2> rows;
  /// The end shapes at the first engine's best α, centroids aligned, over L.
  ShapeDifference shape_difference;
  std::vector<double> curve_gains;                   ///< 0, then log-spaced [N/m]
  std::array<std::vector<double>, 2> curve_errors;   ///< E there [m]; +∞ where a rollout diverged
  std::array<std::vector<double>, 2> curve_efforts;  ///< control effort there; +∞ as well
  /// Of the first engine's flights there; infinite where one diverged.
  std::vector<double> curve_sensitivity, curve_strain;
  std::optional<Divergence> divergence;  ///< if set, the numbers above mean nothing
};

struct ComparisonOptions {
  /// What the search for each engine's best gain asks.
  std::function<Objective(const Backend&)> objective_of = objective;
  /// Called before every other rollout, by several threads at once; what it throws ends the work.
  std::function<void()> before_rollout = [] {};
};

Comparison compare_engines(const std::string& scene, const Backend& first, const Backend& second,
                           const ComparisonOptions& options = {});

/// Whether the engines must agree at the first one's best gain: its flight is neither fragile nor
/// stretched.
bool is_well_conditioned(const Comparison& comparison);

/// What aligned centroids hide of a comparison: an engine that does not bring the cloth's to the
/// target's, in words; empty where both do.
std::string centroid_warning(const Comparison& comparison);

/// Median, 95th percentile (the nearest of the values) and largest of some numbers.
struct Spread {
  double median = 0, most = 0, worst = 0;
};
Spread spread(std::vector<double> values);

/// Comparisons taken together: how far two engines agree where they must, which is on
/// well-conditioned scenes that are launched without stretching.
struct ComparisonSummary {
  std::size_t scenes = 0;
  std::size_t well_conditioned = 0;  ///< whatever the launch
  std::size_t judged = 0;            ///< those among them launched without stretching
  Spread gap;                        ///< of the end shapes, mean over L
  Spread loss;  ///< with the other's best α, over the error with the own one; both engines
  std::size_t curve_points = 0;  ///< well-conditioned points of the E(α) curves of those scenes
  double curve_agreement = 0;    ///< share of them within 2 % or 1e-3·L
};
ComparisonSummary summarize(const std::vector<Comparison>& comparisons);

}  // namespace nuno
