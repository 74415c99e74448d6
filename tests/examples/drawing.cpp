#include <nuno/drawing.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, ADrawnLineIsReadFromItsText) {
  EXPECT_TRUE(is_drawing("shot.svg#cloth"));
  const Points line = parse_csv("x,y\n0,1\n1,1\n", "line.csv");
  EXPECT_EQ(line, (Points{{0, 1}, {1, 1}}));
}

}  // namespace nuno
