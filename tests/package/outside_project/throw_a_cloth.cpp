// A program of somebody else: it knows of nuno only what the installed package gives.
#include <nuno/box2d.h>
#include <nuno/native.h>
#include <nuno/rollout.h>

#include <cstdio>

int main() {
  nuno::ChainScene scene;
  scene.arrival_time = 1;
  scene.initial = (nuno::Points(2, 2) << 0, 1, 1, 1).finished();
  scene.target = (nuno::Points(2, 3) << 3, 3.5, 4, 1, 1.4, 1).finished();
  const nuno::Problem problem = nuno::make_problem(scene);

  const auto native = nuno::native::make_backend(problem);
  const auto box2d = nuno::box2d::make_backend(problem);
  for (const nuno::Backend* backend : {native.get(), box2d.get()}) {
    const nuno::Rollout flight = nuno::rollout(*backend, 0.01);
    if (flight.status != nuno::RolloutStatus::ok) {
      return 1;
    }
    std::printf("%.*s: %.4f m from the target\n", static_cast<int>(backend->name().size()),
                backend->name().data(), flight.error.mean);
  }
  return 0;
}
