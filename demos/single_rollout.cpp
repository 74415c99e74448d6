#include "single_rollout.h"

#include <fmt/format.h>

#include <nuno/conditioning.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include "pictures/summary.h"

namespace nuno {

ExitStatus fly(const SceneFile& file, const Backend& backend, const Gains& gains,
               const std::string& out, const AnimationOptions& animation,
               const std::optional<Optimization>& optimization) {
  const LongWork told(backend, file.scene.name, 2);  // the flight, and the twin that judges it
  const double frames = out.empty() ? 0 : file.scene.frames_per_second;
  const Rollout flight =
      rollout(backend, gains, {.frames_per_second = frames, .tail = animation.tail});
  if (diverged(flight)) {
    report_divergence(file.path, backend, flight);
    return ExitStatus::diverged;
  }
  const double growth = bounded_sensitivity(backend, flight);
  if (!out.empty()) write_flight(out, file, backend, flight, growth, animation, optimization);
  print_summary(people(out), file.scene.name, backend, flight, growth);
  if (file.mesh) {
    for (const std::string& remark : file.mesh->remarks) {
      fmt::print(people(out), "  {:<17} {}\n", "mesh", printable(remark));
    }
  }
  return ExitStatus::done;
}

}  // namespace nuno
