#include <nuno/joint_search.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, ASecondGainIsNoWorseThanOne) {
  const auto backend = native::make_backend(make_problem(arch()));
  const double gain = 0.01;
  const double error = objective(*backend).errors({&gain, 1}).front();
  const JointSearchSummary found =
      joint_search(joint_objective(*backend), {gain, error}, {.groups = 2, .rounds = 5});
  EXPECT_LE(found.stages.back().error, error);
}

}  // namespace nuno
