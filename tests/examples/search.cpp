#include <nuno/search.h>

#include <gtest/gtest.h>

#include "arch.h"

namespace nuno {

TEST(Example, ASearchGivesTheGainAndTheEngineToFlyAt) {
  const SceneFile file = make_scene_file("arch", arch());
  SearchOptions options;
  options.error_limit = 0.1;
  const SearchAnswer answer = search(file, make_backend("native", file), options);
  const Rollout flight = rollout(*answer.backend, answer.gains);
  EXPECT_LE(flight.error.mean, 0.1 * file.problem.cloth().size);
}

}  // namespace nuno
