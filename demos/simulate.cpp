#include <fmt/format.h>

#include <nuno/output.h>
#include "commands.h"
#include "single_rollout.h"

namespace nuno {

ExitStatus simulate(const SimulateOptions& options) {
  SceneFile file = read_scene_file(options.scene, options.changes);
  const PastFlight flown = file.flight.value_or(PastFlight{"native", 0, 0, {}});
  if (!options.changes.reverses_target) {
    file.problem.reference_correction = flown.reference_correction;
  }
  const std::string name = options.backend.empty() ? flown.backend : options.backend;
  const Gains gains = options.gains.value_or(flown.gains);
  require_room(file, options.out, options.animation);
  require_groups(file, gains.count());
  const auto backend = make_backend_for_gain(name, file, gains.largest());
  require_short_tail(*backend, options.animation.tail);
  const bool is_again = file.flight && options.backend.empty() && !options.gains &&
                        !options.changes.time_step && !options.changes.reverses_target;
  // Where the engine's own steps diverge, it takes so many times as many (see judged_rollout).
  const auto is_shortened = [&](Index times) { return flown.steps == times * backend->steps(); };
  if (is_again && !is_shortened(1) && !is_shortened(4) && !is_shortened(16)) {
    note(fmt::format("{}: flown in {} steps, which {} would not take now; this flight differs",
                     file.path, flown.steps, name));
  }
  return fly(file, *backend, gains, options.out, options.animation);
}

}  // namespace nuno
