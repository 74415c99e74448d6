#include <fmt/format.h>

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

  const OptimizeSummary found =
      run_optimizer(options.optimizer, with_progress(objective(*backend), file.scene.name));
  clear_progress();
  // If every rollout diverged, the one at the gain it ended on says why.
  const Rollout flight = rollout(*backend, found.gain, {.frames_per_second = frames});
  if (diverged(flight)) {
    report_divergence(options.scene, *backend, flight);
    return ExitStatus::diverged;
  }
  if (!options.out.empty()) {
    write_output(options.out, [&](std::FILE* out) {
      write_result(out, file.scene.name, *backend, flight, Optimization{options.optimizer, found});
    });
  }
  std::FILE* const summary = people(options.out);
  print_summary(summary, file.scene.name, *backend, flight);
  fmt::print(summary, "  {:<17} {} rollouts in {}{}: {}\n", options.optimizer, found.evaluations,
             duration(found.seconds),
             found.status == OptimizeStatus::budget ? ", budget spent" : "", found.reason);
  return ExitStatus::done;
}

}  // namespace nuno
