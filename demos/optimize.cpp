#include <fmt/format.h>

#include <nuno/feasibility.h>
#include <nuno/refine.h>
#include <nuno/robust.h>
#include <nuno/trade_off.h>

#include <chrono>

#include "commands.h"
#include "engines.h"
#include "json_files.h"
#include "output.h"
#include "rollouts.h"
#include "summary.h"

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
    found.summary.evaluations *= 1 + static_cast<Index>(robustness.disturbances);
  }
  return found;
}

/// The gain that keeps a limit at the least cost; if none does, the nearest to it.
Optimization trade(const OptimizeOptions& options, const SceneFile& file, const Backend& backend) {
  const auto start = std::chrono::steady_clock::now();
  Optimization found{"trade-off", {}};
  found.trade_off = trade_off(backend);
  OptimizeSummary& summary = found.summary;
  summary.evaluations = static_cast<Index>(found.trade_off.size());
  if (found.trade_off.empty()) return found;  // every rollout diverged
  TradeOffPoint point;
  if (options.error_limit) {
    const double limit = *options.error_limit * file.problem.chain.length;
    const auto kept = least_effort(backend, found.trade_off, limit);
    point = kept.value_or(found.trade_off.back());
    summary.status = kept ? OptimizeStatus::converged : OptimizeStatus::budget;
    summary.reason = kept ? "the least effort within the error limit"
                          : "no gain keeps the error limit; this is the nearest";
  } else {
    point = least_error(backend, found.trade_off, *options.effort_limit);
    summary.reason = "the least error within the effort limit";
  }
  summary.gain = point.gain;
  summary.error = point.error;
  for (const TradeOffPoint& at : found.trade_off) summary.history.push_back({at.gain, at.error});
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return found;
}

/// Aims off on the native chain, within the limit that was asked for, and then, on another engine,
/// off what is left there.
RefineSummary aim_off(const OptimizeOptions& options, const SceneFile& file) {
  const MakeBackend model = backend_maker("native", file);
  const double gain = following_gain(*model(file.problem));
  RefineOptions limits;
  if (options.error_limit) limits.tolerance = std::max(limits.tolerance, *options.error_limit);
  if (options.effort_limit) limits.effort_limit = *options.effort_limit;
  RefineSummary refined = refine(file.problem, gain, model, model, limits);
  if (options.backend == "native") return refined;
  Problem aimed = file.problem;
  aimed.aim_offset = refined.aim_offset;
  constexpr double single_precision = 1e-5;
  limits.tolerance = std::max(limits.tolerance, single_precision);
  limits.rounds = 4;
  if (options.effort_limit)
    limits.tolerance =
        std::max(limits.tolerance, refined.flight.error.mean / file.problem.chain.length);
  RefineSummary corrected =
      refine(aimed, gain, backend_maker(options.backend, file), model, limits);
  corrected.rollouts += refined.rollouts;
  corrected.tangents += refined.tangents;
  corrected.seconds += refined.seconds;
  return corrected;
}

}  // namespace

ExitStatus optimize(const OptimizeOptions& options) {
  SceneFile file = read_scene_file(options.scene, options.time_step);
  auto backend = make_backend(options.backend, file);
  const double frames = options.out.empty() ? 0 : file.scene.frames_per_second;
  if (frames > 0) require_few_frames(file);
  require_writable(options.out);
  std::FILE* const summary = people(options.out);
  if (const std::string words = verdict(assess(*backend)); !words.empty()) {
    fmt::print(summary, "{}\n", words);
  }

  Optimization found = options.error_limit || options.effort_limit
                           ? trade(options, file, *backend)
                           : search(options, file, *backend);
  clear_progress();
  double gain = found.summary.gain;
  if (options.refine) {
    found.refinement = aim_off(options, file);
    gain = found.refinement->flight.gain;
    file.problem.aim_offset = found.refinement->aim_offset;
    backend = make_backend(options.backend, file);
  }
  // If every rollout diverged, the one at the gain it ended on says why.
  const Rollout flight = rollout(*backend, gain, {.frames_per_second = frames});
  if (diverged(flight)) {
    report_divergence(options.scene, *backend, flight);
    return ExitStatus::diverged;
  }
  const double growth = bounded_sensitivity(*backend, flight);
  if (!options.out.empty()) {
    write_output(options.out, [&](std::FILE* out) {
      write_result(out, file.scene.name, *backend, flight, growth, found);
    });
  }
  print_summary(summary, file.scene.name, *backend, flight, growth);
  const double percent = 100 / file.problem.chain.length;
  if (found.robust_error) {
    fmt::print(summary, "  {:<17} {:.4g} % of the cloth's length, mean of {} disturbed starts\n",
               "robust error", percent * *found.robust_error, 1 + RobustOptions().disturbances);
  }
  const OptimizeSummary& search = found.summary;
  fmt::print(summary, "  {:<17} {} rollouts in {}{}: {}\n", found.optimizer, search.evaluations,
             duration(search.seconds),
             search.status == OptimizeStatus::budget ? ", not reached" : "", search.reason);
  if (found.refinement) {
    fmt::print(summary, "  {:<17} from {:.4g} % in {} rollouts and {} tangents, {}: {}\n",
               "aiming off", percent * found.refinement->error_before, found.refinement->rollouts,
               found.refinement->tangents, duration(found.refinement->seconds),
               found.refinement->reason);
  }
  return ExitStatus::done;
}

}  // namespace nuno
