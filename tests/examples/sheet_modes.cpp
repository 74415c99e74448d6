#include <nuno/sheet_modes.h>

#include <gtest/gtest.h>

#include "../sheets.h"

namespace nuno {

TEST(Example, TheFirstTwoModesOfASquareAreOfOneWavelength) {
  const Problem problem = make_problem(square(9, 1));
  const SheetModes modes = sheet_modes(problem.sheet(), 2);
  EXPECT_NEAR(modes.eigenvalues[1] / modes.eigenvalues[0], 1, 1e-9);
}

}  // namespace nuno
