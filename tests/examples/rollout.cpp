#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, ARolloutIsLaunchControlAndArrival) {
  const auto backend = native::make_backend(make_problem(arch()));
  const Rollout flight = rollout(*backend, 0.01, {.frames_per_second = 24});
  ASSERT_EQ(flight.status, RolloutStatus::ok);
  EXPECT_LT(flight.error.centroid, 1e-9 * backend->cloth().size);
  EXPECT_EQ(flight.frame_times.size(), 25U);
  EXPECT_EQ(flight.frame_positions.back(), flight.final);
}

}  // namespace nuno
