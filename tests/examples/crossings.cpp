#include <nuno/crossings.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, TwoTrianglesThroughEachOtherCross) {
  Points shape(3, 6);
  shape << 0, 2, 1, 1, 1, 1,  //
      0, 0, 0, -1, 1, 0,      //
      0, 0, 2, 1, 1, 3;
  const std::vector<Crossing> found = crossings(shape, {{0, 1, 2}, {3, 4, 5}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_GT(found.front().depth, 0);
}

}  // namespace nuno
