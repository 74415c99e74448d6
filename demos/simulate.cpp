#include "commands.h"
#include "single_rollout.h"

namespace nuno {

ExitStatus simulate(const SimulateOptions& options) {
  const SceneFile file = read_scene_file(options.scene, options.time_step);
  require_room(file, options.out, options.animation);
  require_groups(file, options.gains.count());
  const auto backend = make_backend_for_gain(options.backend, file, options.gains.largest());
  require_short_tail(*backend, options.animation.tail);
  return fly(file, *backend, options.gains, options.out, options.animation);
}

}  // namespace nuno
