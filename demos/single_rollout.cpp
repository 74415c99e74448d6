#include "single_rollout.h"

#include <nuno/conditioning.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include "pictures/summary.h"

namespace nuno {

SceneFile read_scene_for(const std::string& out, const std::string& path,
                         std::optional<double> time_step) {
  SceneFile file = read_scene_file(path, time_step);
  if (!out.empty()) require_few_frames(file);
  require_writable(out);
  return file;
}

ExitStatus fly(const SceneFile& file, const Backend& backend, const Gains& gains,
               const std::string& out, const std::optional<Optimization>& optimization) {
  const double frames = out.empty() ? 0 : file.scene.frames_per_second;
  const Rollout flight = rollout(backend, gains, {.frames_per_second = frames});
  if (diverged(flight)) {
    report_divergence(file.path, backend, flight);
    return ExitStatus::diverged;
  }
  const double growth = bounded_sensitivity(backend, flight);
  if (!out.empty()) {
    write_output(out, [&](std::FILE* result) {
      write_result(result, file.scene.name, backend, flight, growth, optimization);
    });
  }
  print_summary(people(out), file.scene.name, backend, flight, growth);
  return ExitStatus::done;
}

}  // namespace nuno
