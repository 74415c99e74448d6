#include <fmt/format.h>

#include <nuno/robust.h>

#include "commands.h"
#include "engines.h"
#include "json_files.h"
#include "output.h"
#include "rollouts.h"
#include "summary.h"

namespace nuno {

ExitStatus optimize(const OptimizeOptions& options) {
  const SceneFile file = read_scene_file(options.scene, options.time_step);
  const auto backend = make_backend(options.backend, file);
  const double frames = options.out.empty() ? 0 : file.scene.frames_per_second;
  if (frames > 0) require_few_frames(file);
  require_writable(options.out);

  const RobustOptions robustness;
  Optimization found{options.optimizer, {}, std::nullopt};
  OptimizeSummary& search = found.summary;
  search = run_optimizer(
      options.optimizer,
      with_progress(options.robust ? robust_objective(*backend, robustness) : objective(*backend),
                    file.scene.name));
  clear_progress();
  if (options.robust) {
    found.robust_error = search.error;
    search.evaluations *= 1 + static_cast<Index>(robustness.disturbances);
  }
  // If every rollout diverged, the one at the gain it ended on says why.
  const Rollout flight = rollout(*backend, search.gain, {.frames_per_second = frames});
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
  std::FILE* const summary = people(options.out);
  print_summary(summary, file.scene.name, *backend, flight, growth);
  if (found.robust_error) {
    fmt::print(summary, "  {:<17} {:.4g} % of the cloth's length, mean of {} disturbed starts\n",
               "robust error", 100 / file.problem.chain.length * *found.robust_error,
               1 + robustness.disturbances);
  }
  fmt::print(summary, "  {:<17} {} rollouts in {}{}: {}\n", options.optimizer, search.evaluations,
             duration(search.seconds),
             search.status == OptimizeStatus::budget ? ", budget spent" : "", search.reason);
  return ExitStatus::done;
}

}  // namespace nuno
