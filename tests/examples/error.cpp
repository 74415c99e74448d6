#include <nuno/error.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, AnErrorIsAMeanDistance) {
  const Points target{{0, 1, 2}, {0, 0, 0}};
  Points final = target;
  final(1, 1) += 0.3;  // one particle of three is 0.3 m off
  EXPECT_NEAR(arrival_error(final, target).mean, 0.1, 1e-12);
  EXPECT_NEAR(arrival_error(final, target).centroid, 0.1, 1e-12);
  EXPECT_NEAR(shape_difference(final, target).max, 0.2, 1e-12);
}

}  // namespace nuno
