#pragma once

#include <nuno/backend.h>
#include <nuno/error.h>
#include <nuno/rollout.h>

#include <array>
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
  std::array<ComparisonRow, 2> rows;
  /// The end shapes at the first engine's best α, centroids aligned, over L.
  ShapeDifference shape_difference;
  std::vector<double> curve_gains;                  ///< 0, then log-spaced [N/m]
  std::array<std::vector<double>, 2> curve_errors;  ///< E there [m]; +∞ where a rollout diverged
  std::optional<Divergence> divergence;             ///< if set, the numbers above mean nothing
};

Comparison compare_engines(const std::string& scene, const Backend& first, const Backend& second);

}  // namespace nuno
