#include <fmt/format.h>

#include <nuno/feasibility.h>
#include <nuno/robust.h>
#include <nuno/target_order.h>

#include <cmath>

#include <nuno/conditioning.h>
#include <nuno/output.h>
#include "commands.h"
#include "pictures/summary.h"
#include "single_rollout.h"

namespace nuno {
namespace {

/// Tells people of a target that is drawn the other way round.
void print_target_order(std::FILE* summary, const SceneFile& file, bool is_reversed_here) {
  const auto* const chain = std::get_if<ChainScene>(&file.input);
  if (!chain) return;
  const auto orders = compare_target_orders(*chain, backend_maker("native", file));
  const std::string words = orders ? advice(*orders) : "";
  if (words.empty()) return;
  const bool is_reversed = chain->target_order == TargetOrder::reversed;
  fmt::print(summary, "{}\n{} does so, and in a scene \"target_order\": \"{}\".\n", words,
             is_reversed_here ? "Leaving out --reverse-target" : "--reverse-target",
             is_reversed ? "as-drawn" : "reversed");
}

/// Tells people how the answer was found.
void print_search(std::FILE* summary, const Optimization& found, double length) {
  const double percent = 100 / length;
  if (found.robust_error) {
    fmt::print(summary, "  {:<17} {:.4g} % of the cloth's length, mean of {} perturbed starts\n",
               "robust error", percent * *found.robust_error, 1 + RobustOptions().perturbations);
  }
  const OptimizeSummary& search = found.summary;
  fmt::print(summary, "  {:<17} {} rollouts in {}{}: {}\n", found.optimizer, search.evaluations,
             duration(search.seconds),
             search.status == OptimizeStatus::budget ? ", not reached" : "", search.reason);
  if (found.joint) {
    std::vector<double> errors;
    for (const JointStage& stage : found.joint->stages) errors.push_back(percent * stage.error);
    fmt::print(
        summary, "  {:<17} {:.4g} % with 1 … {} of them, {} rollouts in {}: {}\n", "coefficients",
        fmt::join(errors, ", "), errors.size(), found.joint->evaluations,
        duration(found.joint->seconds),
        found.joint->status == OptimizeStatus::budget ? "rounds ran out" : found.joint->reason);
  }
  if (found.refinement) {
    const RefineSummary& refined = *found.refinement;
    fmt::print(summary, "  {:<17} {}{} rollouts{}, {}: {}\n", "refinement",
               std::isfinite(refined.error_before)
                   ? fmt::format("from {:.4g} % in ", percent * refined.error_before)
                   : "",
               refined.rollouts,
               refined.jacobians > 0 ? fmt::format(" and {} Jacobians", refined.jacobians) : "",
               duration(refined.seconds), refined.reason);
  }
}

}  // namespace

ExitStatus optimize(const OptimizeOptions& options) {
  return optimize(read_scene_file(options.scene, options.changes), options);
}

ExitStatus optimize(const SceneFile& file, const OptimizeOptions& options) {
  require_room(file, options.out, options.animation);
  require_groups(file, options.search.coefficients);
  if (options.search.refine) require_refinable(file);
  auto backend = make_backend(options.backend, file);
  require_short_tail(*backend, options.animation.tail);
  std::FILE* const summary = people(options.out);
  const Feasibility asked = assess(*backend);
  if (const std::string words = verdict(asked); !words.empty()) {
    fmt::print(summary, "{}\n", words);
  } else if (asked.is_sheet) {
    fmt::print(summary, "The target is a shape that cloth can take: its edges fit to {:.2g} %.\n",
               100 * asked.length_mismatch);
  }

  print_target_order(summary, file, options.changes.reverses_target);

  SearchAnswer answer = search(file, std::move(backend), options.search, Telling::progress);
  if (answer.left_refinement_out) {
    fmt::print(summary, "refinement would be no better than the gain alone: left out\n");
  }
  const ExitStatus status =
      fly(file, *answer.backend, answer.gains, options.out, options.animation, answer.how);
  if (status != ExitStatus::done) return status;
  print_search(summary, answer.how, file.problem.cloth().size);
  return ExitStatus::done;
}

}  // namespace nuno
