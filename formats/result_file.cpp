#include <nuno/result_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "compact_json.h"
#include "result_json.h"
#include "scene_json.h"

namespace nuno {
namespace {

using Json = nlohmann::ordered_json;

std::string on_one_line(const Json& value) {
  // A name may come from a file's name, which need not be UTF-8.
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

int depth(const Json& value) {
  int deepest = 0;
  for (const Json& item : value) {
    if (item.is_structured()) deepest = std::max(deepest, depth(item));
  }
  return deepest + (value.is_object() ? 2 : 1);
}

/// Prints a shape, or an object of numbers, on one line, and what holds several of them over
/// several: a line of the file is one thing to look at or to compare.
void print(std::FILE* file, const Json& value, std::size_t indent = 0) {
  if (!value.is_structured() || depth(value) <= 2) {
    fmt::print(file, "{}", on_one_line(value));
    return;
  }
  const bool is_object = value.is_object();
  fmt::print(file, "{}", is_object ? '{' : '[');
  const char* separator = "\n";
  for (const auto& item : value.items()) {
    fmt::print(file, "{}{:{}}", separator, "", indent + 1);
    if (is_object) fmt::print(file, "{}: ", on_one_line(item.key()));
    print(file, item.value(), indent + 1);
    separator = ",\n";
  }
  fmt::print(file, "\n{:{}}{}", "", indent, is_object ? '}' : ']');
}

Json to_json(const Optimization& optimization) {
  Json result = search_head(optimization.optimizer, optimization.summary);
  if (optimization.robust_error) result["robust_error"] = *optimization.robust_error;
  result["history"] = history_of(optimization.summary);
  if (!optimization.pareto_front.empty()) {
    Json curve = Json::array();
    for (const ParetoPoint& point : optimization.pareto_front) {
      curve.push_back(
          {{"alpha", point.gain}, {"error", point.error}, {"control_effort", point.effort}});
    }
    result["pareto_front"] = curve;
  }
  if (optimization.joint) {
    const JointSearchSummary& joint = *optimization.joint;
    Json stages = Json::array();
    for (const JointStage& stage : joint.stages) {
      stages.push_back({{"alphas", stage.gains.groups()}, {"error", stage.error}});
    }
    result["coefficients"] = {{"status", word_for(joint.status)},
                              {"evaluations", joint.evaluations},
                              {"seconds", joint.seconds},
                              {"reason", joint.reason},
                              {"stages", stages}};
  }
  if (optimization.refinement) {
    const RefineSummary& refinement = *optimization.refinement;
    Json& told = result["refinement"];
    told = refinement_head(refinement);
    if (std::isfinite(refinement.error_before)) told["error_before"] = refinement.error_before;
  }
  return result;
}

/// Frames one by one: all of them as JSON at once take ten times their own memory.
void print_frames(std::FILE* file, const Problem& problem, const Rollout& rollout) {
  fmt::print(file, " \"frames\": {{\n  \"times\": {},\n  \"positions\": [",
             on_one_line(rollout.frame_times));
  const char* separator = "\n";
  for (const Points& positions : rollout.frame_positions) {
    problem.stop_where_asked();
    fmt::print(file, "{}   {}", separator, on_one_line(json_of(positions)));
    separator = ",\n";
  }
  fmt::print(file, "\n  ]\n }}");
}

Json to_json(const ComparisonRow& row) {
  return {{"backend", row.backend},
          {"launch_only_error", row.launch_only_error},
          {"alpha", row.gain},
          {"error", row.error.mean},
          {"max_error", row.error.max},
          {"centroid_error", row.error.centroid},
          {"control_effort", row.control_effort},
          {"max_strain", row.max_strain},
          {"sensitivity", row.sensitivity},
          {"evaluations", row.evaluations},
          {"seconds", row.seconds},
          {"error_with_the_other_alpha", row.error_with_the_other_gain}};
}

Json to_json(const Comparison& comparison) {
  Json curve = {{"alpha", comparison.curve_gains}}, efforts;
  for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
    curve[comparison.rows[i].backend] = comparison.curve_errors[i];  // infinity becomes null
    efforts[comparison.rows[i].backend] = comparison.curve_efforts[i];
  }
  curve["control_effort"] = efforts;
  curve["sensitivity"] = comparison.curve_sensitivity;
  curve["max_strain"] = comparison.curve_strain;
  return {{"scene", comparison.scene},
          {"rows", {to_json(comparison.rows[0]), to_json(comparison.rows[1])}},
          {"shape_difference",
           {{"at_alpha", comparison.rows[0].gain},
            {"mean", comparison.shape_difference.mean},
            {"max", comparison.shape_difference.max}}},
          {"alpha_curve", curve}};
}

}  // namespace

std::string optimization_to_json(const Optimization& optimization) {
  return to_json(optimization).dump();
}

void write_result(std::FILE* file, const AnyScene& input, const Backend& backend,
                  const Rollout& rollout, double sensitivity,
                  const std::optional<Optimization>& optimization) {
  write_result(file, input, backend, rollout, sensitivity,
               optimization ? optimization_to_json(*optimization) : "");
}

void write_result(std::FILE* file, const AnyScene& input, const Backend& backend,
                  const Rollout& rollout, double sensitivity, const std::string& optimization) {
  const Problem& problem = backend.problem();
  Json head = {{"nuno_result", 1}};
  head.update(result_head(scene_of(input).name, backend, rollout));
  head["sensitivity"] = sensitivity;
  if (rollout.gains.count() > 1) head["alphas"] = rollout.gains.groups();
  for (const Points& correction : problem.reference_correction) {
    head["reference_correction"].push_back(json_of(correction));
  }
  if (!optimization.empty()) head["optimization"] = Json::parse(optimization);
  if (problem.is_sheet()) {
    head["kind"] = "sheet";
    head["faces"] = problem.sheet().faces;
    head["crossings"] =
        crossings_head(flight_crossings(problem, rollout.frame_times, rollout.frame_positions));
  }
  head["input"] = json_of(input);
  head["launch_velocity"] = json_of(rollout.launch_velocity);
  head["target"] = json_of(problem.target);
  head["final"] = json_of(rollout.final);
  head["final_velocity"] = json_of(rollout.final_velocity);

  fmt::print(file, "{{\n");
  for (const auto& item : head.items()) {
    fmt::print(file, " {}: ", on_one_line(item.key()));
    print(file, item.value(), 1);
    fmt::print(file, ",\n");
  }
  print_frames(file, problem, rollout);
  fmt::print(file, "\n}}\n");
}

void write_comparisons(std::FILE* file, const std::vector<Comparison>& comparisons) {
  Json scenes = Json::array();
  for (const Comparison& comparison : comparisons) scenes.push_back(to_json(comparison));
  print(file, {{"nuno_comparison", 1}, {"scenes", scenes}});
  fmt::print(file, "\n");
}

}  // namespace nuno
