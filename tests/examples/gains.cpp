#include <nuno/gains.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, GainsAreOneForAllModesOrOneForEachGroup) {
  EXPECT_EQ(Gains(0.5).groups(), std::vector<double>{0.5});
  const std::vector<double> groups = {0.9, 0.1};  // of the two longest waves, and of the rest
  EXPECT_EQ(Gains::of_groups(groups).largest(), 0.9);
  EXPECT_GT(fewest_particles(3), fewest_particles(2));
}

}  // namespace nuno
