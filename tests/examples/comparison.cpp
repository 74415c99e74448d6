#include <nuno/comparison.h>

#include <gtest/gtest.h>

#include <nuno/box2d.h>
#include <nuno/native.h>
#include "arch.h"

namespace nuno {

TEST(Example, TwoEnginesAreComparedOnOneProblem) {
  const Problem problem = make_problem(arch());
  const auto first = native::make_backend(problem), second = box2d::make_backend(problem);
  const Comparison comparison = compare_engines("arch", *first, *second);
  ASSERT_FALSE(comparison.divergence);
  EXPECT_EQ(comparison.rows[1].backend, "box2d");
  EXPECT_EQ(summarize({comparison}).scenes, 1U);
}

}  // namespace nuno
