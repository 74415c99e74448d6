#include <fmt/format.h>

#include <nuno/feasibility.h>
#include <nuno/pareto_front.h>
#include <nuno/robust.h>
#include <nuno/target_order.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>

#include <nuno/conditioning.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include "commands.h"
#include "pictures/summary.h"
#include "single_rollout.h"

namespace nuno {
namespace {

/// The gain of least error.
Optimization search(const OptimizeOptions& options, const SceneFile& file, const Backend& backend) {
  const RobustOptions robustness;
  const Objective errors =
      options.robust ? robust_objective(backend, robustness) : objective(backend);
  Optimization found{options.optimizer,
                     run_optimizer(options.optimizer, with_progress(errors, file.scene.name))};
  if (options.robust) {
    found.robust_error = found.summary.error;
    found.summary.evaluations *= 1 + static_cast<Index>(robustness.perturbations);
  }
  return found;
}

/// The gain that keeps a limit at the least cost; if none does, the nearest to it.
Optimization search_front(const OptimizeOptions& options, const SceneFile& file,
                          const Backend& backend) {
  const auto start = std::chrono::steady_clock::now();
  Optimization found{"pareto-front", {}};
  OptimizeSummary& summary = found.summary;
  std::atomic<Index> rollouts = 0;
  const auto count = [&] { ++rollouts; };
  found.pareto_front = pareto_front(backend, 64, count);
  summary.evaluations = rollouts;
  if (found.pareto_front.empty()) return found;  // every rollout diverged
  ParetoPoint point;
  if (options.error_limit) {
    const double limit = *options.error_limit * file.problem.cloth().size;
    const auto kept = least_effort(backend, found.pareto_front, limit, count);
    point = kept.value_or(found.pareto_front.back());
    summary.status = kept ? OptimizeStatus::converged : OptimizeStatus::budget;
    summary.reason = kept ? "the least effort within the error limit"
                          : "no gain keeps the error limit; this is the nearest";
  } else {
    point = least_error(backend, found.pareto_front, *options.effort_limit, count);
    summary.reason = "the least error within the effort limit";
  }
  summary.evaluations = rollouts;
  summary.gain = point.gain;
  summary.error = point.error;
  for (const ParetoPoint& at : found.pareto_front) summary.history.push_back({at.gain, at.error});
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return found;
}

/// Whether a flight serves the asked better than another: one within the limits than one without;
/// then, under an error limit, by effort, else by error.
bool is_better(const Rollout& a, const Rollout& b, const OptimizeOptions& options, double length) {
  const auto kept = [&](const Rollout& flight) {
    return (!options.error_limit || flight.error.mean <= *options.error_limit * length) &&
           (!options.effort_limit || flight.control_effort <= *options.effort_limit);
  };
  if (kept(a) != kept(b)) return kept(a);
  return options.error_limit && kept(a) ? a.control_effort < b.control_effort
                                        : a.error.mean < b.error.mean;
}

RefineOptions limits_of(const OptimizeOptions& options) {
  RefineOptions limits;
  if (options.error_limit) limits.tolerance = std::max(limits.tolerance, *options.error_limit);
  if (options.effort_limit) limits.effort_limit = *options.effort_limit;
  return limits;
}

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
    fmt::print(summary, "  {:<17} {}{} rollouts and {} Jacobians, {}: {}\n", "refinement",
               std::isfinite(refined.error_before)
                   ? fmt::format("from {:.4g} % in ", percent * refined.error_before)
                   : "",
               refined.rollouts, refined.jacobians, duration(refined.seconds), refined.reason);
  }
}

}  // namespace

ExitStatus optimize(const OptimizeOptions& options) {
  return optimize(read_scene_file(options.scene, options.changes), options);
}

ExitStatus optimize(SceneFile file, const OptimizeOptions& options) {
  require_room(file, options.out, options.animation);
  require_groups(file, options.coefficients);
  if (options.refine) require_refinable(file);
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

  Optimization found = [&] {
    const LongWork told(*backend, file.scene.name, flights_of_search(*backend));
    return options.error_limit || options.effort_limit ? search_front(options, file, *backend)
                                                       : search(options, file, *backend);
  }();
  Gains gains = found.summary.gain;
  double error = found.summary.error;
  if (options.coefficients > 1) {
    const JointObjective errors = with_progress(joint_objective(*backend), file.scene.name);
    found.joint =
        joint_search(errors, {found.summary.gain, error}, {.groups = options.coefficients});
    gains = found.joint->stages.back().gains;
    error = found.joint->stages.back().error;
  }
  clear_progress();
  if (options.refine) {
    RefineSummary refined = refine_on(options.backend, file, limits_of(options));
    if (is_better(refined.flight, rollout(*backend, gains), options, file.problem.cloth().size)) {
      found.refinement = std::move(refined);
      gains = found.refinement->flight.gains;
      file.problem.reference_correction = found.refinement->reference_correction;
      backend = make_backend(options.backend, file);
    } else {
      fmt::print(summary, "refinement would be no better than the gain alone: left out\n");
    }
  }
  // If every rollout diverged, the one at the gain it ended on says why.
  const ExitStatus status = fly(file, *backend, gains, options.out, options.animation, found);
  if (status != ExitStatus::done) return status;
  print_search(summary, found, file.problem.cloth().size);
  return ExitStatus::done;
}

}  // namespace nuno
