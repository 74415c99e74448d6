#include "problems.h"

#include <cmath>

#include "scene_library.h"

namespace nuno::bench {

ChainScene straight_to_s(Index particles) {
  ChainScene scene = scene_library::straight_to_s();
  scene.particles = particles;
  return scene;
}

Problem release(Index particles) {
  ChainScene scene = straight_to_s(particles);
  scene.name = "release";
  scene.cloth.air_drag = 0;
  scene.initial = scene.target;
  scene.target.row(1).array() -= 0.5 * scene.gravity * scene.arrival_time * scene.arrival_time;
  return make_problem(scene);
}

std::vector<double> spread_gains(double scale, Index count) {
  std::vector<double> gains = {0};
  for (Index i = 1; i < count; ++i) {
    gains.push_back(scale *
                    std::pow(10, -1 + 3 * static_cast<double>(i) / static_cast<double>(count)));
  }
  return gains;
}

}  // namespace nuno::bench
