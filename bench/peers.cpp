#include "peers.h"

namespace nuno::bench {

std::vector<Peer> peers(const Problem& problem, Index steps) {
  std::vector<Peer> result = b2rope_peers(problem, steps);
  [[maybe_unused]] const auto append = [&](std::vector<Peer> more) {
    for (Peer& peer : more) result.push_back(std::move(peer));
  };
#ifdef NUNO_BENCH_CHIPMUNK
  append(chipmunk_peers(problem, steps));
#endif
#ifdef NUNO_BENCH_BULLET
  append(bullet_peers(problem, steps));
#endif
#ifdef NUNO_BENCH_MUJOCO
  append(mujoco_peers(problem, steps));
#endif
  return result;
}

std::vector<Peer> sheet_peers([[maybe_unused]] const Problem& problem) {
  std::vector<Peer> result;
#ifdef NUNO_BENCH_BULLET
  for (Peer& peer : bullet_sheet_peers(problem)) result.push_back(std::move(peer));
#endif
#ifdef NUNO_BENCH_MUJOCO
  for (Peer& peer : mujoco_sheet_peers(problem)) result.push_back(std::move(peer));
#endif
  return result;
}

std::vector<Rod> rods(const Chain& chain) {
  std::vector<Rod> result;
  const Index count = chain.rest_length.size();
  for (Index i = 0; i < count; ++i) {
    const double first = chain.particle_mass * (i == 0 ? 1 : 0.5);
    const double second = chain.particle_mass * (i + 1 == count ? 1 : 0.5);
    Rod rod;
    rod.length = chain.rest_length[i];
    rod.mass = first + second;
    rod.center = second / rod.mass * rod.length;
    rod.inertia = first * second / rod.mass * rod.length * rod.length;
    result.push_back(rod);
  }
  return result;
}

}  // namespace nuno::bench
