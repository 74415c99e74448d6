#include <nuno/problem.h>

#include <gtest/gtest.h>

#include "arch.h"

namespace nuno {

TEST(Example, ASceneBecomesAProblem) {
  const Problem problem = make_problem(arch());
  EXPECT_EQ(problem.cloth().particles(), arch().particles);
  EXPECT_FALSE(problem.is_sheet());
  // `fit` gave the target the cloth's length.
  EXPECT_NEAR(segment_lengths(problem.target).sum(), problem.cloth().size, 1e-12);
}

}  // namespace nuno
