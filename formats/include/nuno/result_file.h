#pragma once

#include <nuno/backend.h>
#include <nuno/joint_search.h>
#include <nuno/optimize.h>
#include <nuno/pareto_front.h>
#include <nuno/refine.h>
#include <nuno/rollout.h>
#include <nuno/scene_file.h>

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <nuno/comparison.h>

namespace nuno {

/// How the gain of a result was found.
struct Optimization {
  std::string optimizer;
  OptimizeSummary summary;
  std::optional<double> robust_error = {};  ///< of a robust search: mean over perturbed starts [m]
  std::vector<ParetoPoint> pareto_front = {};    ///< where a limit was asked for
  std::optional<JointSearchSummary> joint = {};  ///< where there are several coefficients
  std::optional<RefineSummary> refinement = {};  ///< where the flight is refined
};

/// The result JSON of one rollout, which has not diverged, of the scene `input`: it holds all that
/// read_scene_or_result needs, for it to be flown again.
void write_result(std::FILE* file, const AnyScene& input, const Backend& backend,
                  const Rollout& rollout, double sensitivity,
                  const std::optional<Optimization>& optimization);

/// What such a file says of the search, as JSON text.
std::string optimization_to_json(const Optimization& optimization);

/// The same result with that text in the place of the search; empty where there was none.
void write_result(std::FILE* file, const AnyScene& input, const Backend& backend,
                  const Rollout& rollout, double sensitivity, const std::string& optimization);

/// compare.json. A point of an alpha curve at which a rollout diverged is null; nothing else is.
void write_comparisons(std::FILE* file, const std::vector<Comparison>& comparisons);

}  // namespace nuno
