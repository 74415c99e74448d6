#include <nuno/points.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, APolylineBecomesParticlesOfEqualDistance) {
  const Points drawn{{0, 2, 2}, {0, 0, 1}};  // a row for x, a row for y
  const Points particles = resample(drawn, 7);
  EXPECT_EQ(particles.cols(), 7);
  EXPECT_NEAR(segment_lengths(particles).maxCoeff(), 0.5, 1e-12);
  EXPECT_LT(centroid(shape_of(particles)).norm(), 1e-12);
}

}  // namespace nuno
