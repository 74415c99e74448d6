#include "commands.h"
#include "single_rollout.h"

namespace nuno {

ExitStatus simulate(const SimulateOptions& options) {
  const SceneFile file = read_scene_file(options.scene, options.time_step);
  require_room(file, options.out);
  require_groups(file, options.gains.count());
  return fly(file, *make_backend_for_gain(options.backend, file, options.gains.largest()),
             options.gains, options.out);
}

}  // namespace nuno
