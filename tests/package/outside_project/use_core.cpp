#include <nuno/launch.h>

#include "thrown.h"

int main() {
  const nuno::Problem problem = chain_problem();
  const nuno::Cloth& cloth = problem.cloth();
  const nuno::Points velocity = nuno::ballistic_launch(
      cloth.initial, problem.target, problem.arrival_time, cloth.gravity, cloth.drag_rate);
  return velocity.allFinite() && velocity.cols() == cloth.particles() ? 0 : 1;
}
