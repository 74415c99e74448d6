#include <nuno/rollout_gradient.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "../sheets.h"

namespace nuno {

TEST(Example, TheGradientSaysWhatTheErrorGainsByTheLaunch) {
  const auto backend = native::make_backend(make_problem(throw_scene()));
  ASSERT_TRUE(backend->has_gradient());
  const RolloutGradient gradient = backend->error_gradient(0.1);
  EXPECT_EQ(gradient.launch.cols(), backend->cloth().particles());
  EXPECT_GT(gradient.launch.norm(), 0);
}

}  // namespace nuno
