#include <nuno/engines.h>

#include "thrown.h"

int main() {
  nuno::ChainScene scene;
  scene.arrival_time = 1;
  scene.initial = (nuno::Points(2, 2) << 0, 1, 1, 1).finished();
  scene.target = (nuno::Points(2, 3) << 3, 3.5, 4, 1, 1.4, 1).finished();
  const nuno::SceneFile file = nuno::make_scene_file("a scene", scene);
  int failed = 0;
  for (const std::string_view name : nuno::engines_for(file.problem)) {
    failed += throw_with(*nuno::make_backend(name, file));
  }
  return failed;
}
