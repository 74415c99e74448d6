#pragma once

#include <nuno/scene.h>

namespace nuno {

/// A metre of cloth, to be an arch three metres away after one second.
inline ChainScene arch() {
  ChainScene scene;
  scene.arrival_time = 1;
  scene.initial = Points{{0, 1}, {1, 1}};
  scene.target = Points{{3.0, 3.2, 3.5, 3.8, 4.0}, {1.0, 1.3, 1.4, 1.3, 1.0}};
  return scene;
}

}  // namespace nuno
