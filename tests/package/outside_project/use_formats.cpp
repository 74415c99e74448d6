#include <nuno/scene_file.h>

#include "thrown.h"

int main() {
  const nuno::ChainScene scene = nuno::parse_scene(
      R"({"nuno_scene": 1, "arrival_time": 1, "initial": [[0, 1], [1, 1]],
          "target": [[3, 1], [3.5, 1.4], [4, 1]]})",
      "a scene");
  return nuno::make_problem(scene).target.cols() == 32 ? 0 : 1;
}
