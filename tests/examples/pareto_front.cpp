#include <nuno/pareto_front.h>

#include <gtest/gtest.h>

#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, LessEffortIsBoughtWithMoreError) {
  const auto backend = native::make_backend(make_problem(arch()));
  const std::vector<ParetoPoint> front = pareto_front(*backend, 12);
  ASSERT_FALSE(front.empty());
  const double limit = 2 * front.back().error;
  const auto cheap = least_effort(*backend, front, limit);
  ASSERT_TRUE(cheap);
  EXPECT_LE(cheap->error, limit);
  EXPECT_LE(cheap->effort, front.back().effort);
}

}  // namespace nuno
