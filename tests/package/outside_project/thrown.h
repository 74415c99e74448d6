#pragma once

#include <nuno/rollout.h>

#include <cstdio>

// Somebody else's programs: they know of nuno only what the installed package gives.

inline nuno::Problem chain_problem() {
  nuno::ChainScene scene;
  scene.arrival_time = 1;
  scene.initial = (nuno::Points(2, 2) << 0, 1, 1, 1).finished();
  scene.target = (nuno::Points(2, 3) << 3, 3.5, 4, 1, 1.4, 1).finished();
  return nuno::make_problem(scene);
}

inline nuno::Problem sheet_problem() {
  nuno::SheetScene scene;
  scene.arrival_time = 1;
  scene.initial = (nuno::Points(3, 4) << 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 1, 1).finished();
  scene.target = scene.initial.colwise() + Eigen::Vector3d(2, 1, 0);
  scene.faces = {{0, 1, 2, 3}};
  return nuno::make_problem(scene);
}

/// Exit status: 0 where the cloth arrives.
inline int throw_with(const nuno::Backend& backend) {
  const nuno::Rollout flight = nuno::rollout(backend, 0.01);
  std::printf("%.*s: %.4f m from the target\n", static_cast<int>(backend.name().size()),
              backend.name().data(), flight.error.mean);
  return flight.status == nuno::RolloutStatus::ok && flight.error.centroid < 1e-3 ? 0 : 1;
}
