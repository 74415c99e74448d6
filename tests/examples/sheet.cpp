#include <nuno/sheet.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, ASheetHasSpringsAndHinges) {
  const Points corners{{0, 1, 1, 0}, {0, 0, 0, 0}, {0, 0, 1, 1}};
  const Faces faces = {{0, 1, 2}, {0, 2, 3}};
  const Sheet sheet = make_sheet(corners, faces, {.areal_density = 0.2}, Rest::initial, 9.8);
  EXPECT_NEAR(area(corners, faces), 1, 1e-12);
  EXPECT_NEAR(4 * sheet.particle_mass, 0.2, 1e-12);
  EXPECT_EQ(sheet.stretch.count(), 5);
  EXPECT_EQ(sheet.hinges.count(), 1);
}

}  // namespace nuno
