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
  Json head = {{"scene", scene},
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
               {"max_strain", rollout.max_strain},
               {"truncation_error", rollout.truncation_error}};
  // Infinity becomes null.
  if (rollout.step_error) head["step_error"] = *rollout.step_error;
  if (rollout.finer_strain) head["finer_strain"] = *rollout.finer_strain;
  return head;
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

Json crossings_head(const FlightCrossings& crossings) {
  Json result = {{"frames", crossings.frames},
                 {"crossed_frames", crossings.crossed_frames},
                 {"grounded_frames", crossings.grounded_frames}};
  if (crossings.crossed_frames > 0) {
    result["most_pairs"] = crossings.most_pairs;
    result["first_time"] = crossings.first_time;
    result["depth"] = crossings.depth;
    result["deepest_time"] = crossings.deepest_time;
  }
  if (crossings.grounded_frames > 0) {
    result["ground_time"] = crossings.ground_time;
    result["ground_depth"] = crossings.ground_depth;
  }
  return result;
}

Json refinement_head(const RefineSummary& refinement) {
  return {{"status", refinement.converged ? "converged" : "nearest"},
          {"reason", refinement.reason},
          {"rollouts", refinement.rollouts},
          {"jacobians", refinement.jacobians},
          {"seconds", refinement.seconds}};
}

}  // namespace nuno
