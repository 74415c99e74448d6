#include <nuno/launch.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, ALoneParticleArrives) {
  const Points from{{0.0}, {1.0}}, to{{3.0}, {2.0}};
  const Points velocity = ballistic_launch(from, to, 1, 9.8, 0);
  EXPECT_NEAR(velocity(0, 0), 3, 1e-12);
  EXPECT_NEAR(velocity(1, 0), 1 + 9.8 / 2, 1e-12);  // v·t₀ − g·t₀²/2 = 1
}

}  // namespace nuno
