// nuno throw: two meshes or drawings in, a flight out.

#include <fmt/format.h>

#include <nuno/animation.h>
#include "commands.h"
#include "single_rollout.h"

namespace nuno {

ExitStatus throw_cloth(const ThrowOptions& options) {
  const std::string& out = options.out;
  if (!out.empty() && out != "-" && !is_animation(out) && !out.ends_with(".json")) {
    throw InputError(fmt::format("--out: \"{}\" does not end in .json or {}", out,
                                 fmt::join(animation_extensions, ", ")));
  }
  const std::string source = throw_source(options.start, options.target);
  AnyScene scene = throw_scene(options.request, options.start, options.target);
  if (options.reverses_target) scene = with_reversed_target(std::move(scene), source);
  const SceneFile file = make_scene_file(source, std::move(scene));
  OptimizeOptions search;
  search.backend = options.backend;
  search.out = out;
  search.search.error_limit = options.error_limit;
  search.search.refine = options.refine;
  search.changes.reverses_target = options.reverses_target;
  search.animation = options.animation;
  return optimize(file, search);
}

}  // namespace nuno
