// Throws a metre of cloth so that it arrives three metres away as an arch, after one second.
#include <nuno/native.h>
#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <iostream>

int main() {
  nuno::ChainScene scene;
  scene.arrival_time = 1;
  scene.initial = nuno::Points{{0, 1}, {1, 1}};  // a row for x, a row for y, a column per point
  scene.target = nuno::Points{{3.0, 3.2, 3.5, 3.8, 4.0}, {1.0, 1.3, 1.4, 1.3, 1.0}};

  const auto cloth = nuno::native::make_backend(nuno::make_problem(scene));
  const auto launch_only = nuno::rollout(*cloth, 0);
  const auto best = nuno::global_search(nuno::objective(*cloth));
  const auto flight = nuno::rollout(*cloth, best.gain);

  std::cout << "launch only: " << launch_only.error.mean << " m from the target\n"
            << "controlled:  " << flight.error.mean << " m, at a gain of " << best.gain << " N/m\n";
}
