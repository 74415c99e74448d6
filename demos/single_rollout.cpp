#include "single_rollout.h"

#include <fmt/format.h>

#include <nuno/conditioning.h>
#include <nuno/glb_file.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include "pictures/summary.h"

namespace nuno {

namespace {

bool is_animated_mesh(const std::string& out) { return out.ends_with(".glb"); }

}  // namespace

void require_room(const SceneFile& file, const std::string& out) {
  if (is_animated_mesh(out) && !file.mesh) {
    throw InputError(
        fmt::format("--out: {}: a .glb holds a sheet, and {} is a chain", out, file.path));
  }
  if (!out.empty()) require_few_frames(file);
  require_writable(out);
}

ExitStatus fly(const SceneFile& file, const Backend& backend, const Gains& gains,
               const std::string& out, const std::optional<Optimization>& optimization) {
  const LongWork told(backend, file.scene.name, 2);  // the flight, and the twin that judges it
  const double frames = out.empty() ? 0 : file.scene.frames_per_second;
  const Rollout flight = rollout(backend, gains, {.frames_per_second = frames});
  if (diverged(flight)) {
    report_divergence(file.path, backend, flight);
    return ExitStatus::diverged;
  }
  const double growth = bounded_sensitivity(backend, flight);
  if (!out.empty()) {
    write_output(out, [&](std::FILE* result) {
      if (is_animated_mesh(out)) {
        write_glb(result, file.scene.name, *file.mesh, flight.frame_times, flight.frame_positions);
      } else {
        write_result(result, file.scene.name, backend, flight, growth, optimization);
      }
    });
  }
  print_summary(people(out), file.scene.name, backend, flight, growth);
  return ExitStatus::done;
}

}  // namespace nuno
