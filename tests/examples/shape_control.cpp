#include <nuno/shape_control.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, ControlCorrectsTheShapeAndNeverThePlace) {
  const Points target{{-1, 0, 1}, {0, 0.3, 0}};
  const Points positions{{7, 8, 9}, {5, 5, 5}};  // elsewhere, and straight
  Points forces(2, 3);
  shape_control(shape_of(target), positions, 2, forces);
  EXPECT_LT(forces.rowwise().sum().norm(), 1e-12);
  EXPECT_NEAR(forces(1, 1), 2 * 0.2, 1e-12);
}

}  // namespace nuno
