#include "commands.h"
#include "engines.h"
#include "json_files.h"
#include "output.h"
#include "rollouts.h"
#include "summary.h"

namespace nuno {

ExitStatus simulate(const SimulateOptions& options) {
  const SceneFile file = read_scene_file(options.scene, options.time_step);
  require_groups(file, options.gains.count());
  const auto backend = make_backend_for_gain(options.backend, file, options.gains.largest());
  const double frames = options.out.empty() ? 0 : file.scene.frames_per_second;
  if (frames > 0) require_few_frames(file);
  require_writable(options.out);

  const Rollout flight = rollout(*backend, options.gains, {.frames_per_second = frames});
  if (diverged(flight)) {
    report_divergence(options.scene, *backend, flight);
    return ExitStatus::diverged;
  }
  const double growth = bounded_sensitivity(*backend, flight);
  if (!options.out.empty()) {
    write_output(options.out, [&](std::FILE* out) {
      write_result(out, file.scene.name, *backend, flight, growth, std::nullopt);
    });
  }
  print_summary(people(options.out), file.scene.name, *backend, flight, growth);
  return ExitStatus::done;
}

}  // namespace nuno
