#include "result_json.h"

#include <cmath>

namespace nuno {

using Json = nlohmann::ordered_json;

std::string_view word_for(OptimizeStatus status) {
  return status == OptimizeStatus::converged ? "converged" : "budget";
}

Json result_head(const std::string& scene, const Backend& backend, const Rollout& rollout) {
  const Problem& problem = backend.problem();
  const double size = problem.cloth().size;
  return {{"scene", scene},
          {"backend", backend.name()},
          {"status", "ok"},
          {"alpha", rollout.gains.rest},
          {"time_step", backend.time_step()},
          {"steps", backend.steps()},
          {problem.is_sheet() ? "size" : "cloth_length", size},
          {"target_scale", problem.target_scale},
          {"error",
           {{"mean", rollout.error.mean},
            {"max", rollout.error.max},
            {"centroid", rollout.error.centroid},
            {"relative", rollout.error.mean / size}}},
          {"control_effort", rollout.control_effort},
          {"max_strain", rollout.max_strain}};
}

Json search_head(const std::string& optimizer, const OptimizeSummary& summary) {
  return {{"optimizer", optimizer},
          {"status", word_for(summary.status)},
          {"reason", summary.reason},
          {"at_largest_gain", summary.at_largest_gain},
          {"evaluations", summary.evaluations},
          {"seconds", summary.seconds}};
}

Json history_of(const OptimizeSummary& summary) {
  Json history = Json::array();
  for (const Evaluation& evaluation : summary.history) {
    if (!std::isfinite(evaluation.error)) continue;
    history.push_back({{"alpha", evaluation.gain}, {"error", evaluation.error}});
  }
  return history;
}

Json refinement_head(const RefineSummary& refinement) {
  return {{"status", refinement.converged ? "converged" : "nearest"},
          {"reason", refinement.reason},
          {"rollouts", refinement.rollouts},
          {"jacobians", refinement.jacobians},
          {"seconds", refinement.seconds}};
}

}  // namespace nuno
