#include "single_rollout.h"

#include <fmt/format.h>

#include <cmath>

#include <nuno/conditioning.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include "pictures/summary.h"

namespace nuno {

namespace {

/// Tells people of a step that is not the one that they asked for.
void print_shorter_step(std::FILE* people, const SceneFile& file, const Backend& backend) {
  const std::optional<double>& asked = file.scene.time_step;
  if (!asked) return;
  const double enough = std::ceil(file.scene.arrival_time / *asked * (1 - 1e-12));
  if (static_cast<double>(backend.steps()) <= enough) return;
  fmt::print(people, "  {:<17} {}, not {}: {} needs shorter ones for this cloth and gain\n",
             "time step", duration(backend.time_step()), duration(*asked), backend.name());
}

}  // namespace

ExitStatus fly(const SceneFile& file, const Backend& asked, const Gains& gains,
               const std::string& out, const AnimationOptions& animation,
               const std::optional<Optimization>& optimization) {
  // The flight, and those that judge it: its twin, and where in doubt at half of its step.
  const LongWork told(asked, file.scene.name, 4);
  // A sheet's are looked at, for where it passes through itself.
  const bool keeps_frames = !out.empty() || file.problem.is_sheet();
  const double frames = keeps_frames ? file.scene.frames_per_second : 0;
  JudgedRollout flown =
      judged_rollout(asked, file, gains, {.frames_per_second = frames, .tail = animation.tail});
  const Rollout& flight = flown.flight;
  if (diverged(flight)) {
    report_divergence(file.path, asked, flight);
    return ExitStatus::diverged;
  }
  const Backend& backend = flown.finer ? *flown.finer : asked;
  if (!out.empty())
    write_flight(out, file, backend, flight, flown.sensitivity, animation, optimization);
  print_summary(people(out), file.scene.name, backend, flight, flown.sensitivity);
  if (flown.finer) {
    fmt::print(people(out), "  {:<17} it diverges in {} steps of {}\n", "shorter steps",
               asked.steps(), duration(asked.time_step()));
  }
  print_shorter_step(people(out), file, backend);
  if (const Mesh* const mesh = file.mesh()) {
    for (const std::string& remark : mesh->remarks) {
      fmt::print(people(out), "  {:<17} {}\n", "mesh", printable(remark));
    }
  }
  return ExitStatus::done;
}

}  // namespace nuno
