#include <nuno/points.h>

#include <gtest/gtest.h>

#include <cmath>

namespace nuno {
namespace {

Points line(std::initializer_list<Eigen::Vector2d> points) {
  Points result(2, static_cast<Index>(points.size()));
  Index i = 0;
  for (const auto& point : points) result.col(i++) = point;
  return result;
}

TEST(Resample, SplitsAStraightLineEvenly) {
  const Points points = resample(line({{0, 1}, {3, 1}}), 4);
  for (Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(points(0, i), static_cast<double>(i), 1e-15);
    EXPECT_EQ(points(1, i), 1);
  }
}

TEST(Resample, WalksEqualArcLengthAroundACorner) {
  const Points points = resample(line({{0, 0}, {1, 0}, {1, 3}}), 5);
  EXPECT_EQ(points.col(1), Eigen::Vector2d(1, 0));
  EXPECT_EQ(points.col(2), Eigen::Vector2d(1, 1));
  EXPECT_EQ(points.col(3), Eigen::Vector2d(1, 2));
}

TEST(Resample, KeepsTheEndsToTheLastBit) {
  const Points drawn = line({{0.1, 0.2}, {0.3, 0.7}, {1.1, 0.4}});
  const Points points = resample(drawn, 7);
  EXPECT_EQ(points.col(0), drawn.col(0));
  EXPECT_EQ(points.col(6), drawn.col(2));
}

TEST(Resample, IsBlindToRepeatedPoints) {
  const Points once = line({{0, 0}, {1, 0}, {1, 2}});
  const Points twice = line({{0, 0}, {0, 0}, {0, 0}, {1, 0}, {1, 0}, {1, 2}, {1, 2}});
  EXPECT_EQ(resample(once, 9), resample(twice, 9));
}

TEST(Resample, IsBlindToUnevenSpacingOfTheDrawing) {
  // A hundred thousand points, crowded towards one end of the same line.
  Points drawn(2, 100'000);
  for (Index i = 0; i < drawn.cols(); ++i) {
    const double s = std::pow(static_cast<double>(i) / static_cast<double>(drawn.cols() - 1), 3);
    drawn.col(i) = Eigen::Vector2d(2 * s, -s);
  }
  const Points expected = resample(line({{0, 0}, {2, -1}}), 64);
  // 1e5 additions of lengths that round at 1e-16 each.
  EXPECT_LT((resample(drawn, 64) - expected).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(Resample, GivesSegmentsOfNearlyEqualLengthOnASmoothCurve) {
  Points drawn(2, 1000);
  for (Index i = 0; i < drawn.cols(); ++i) {
    const double angle = 3e-3 * static_cast<double>(i);
    drawn.col(i) = Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  const Vector lengths = segment_lengths(resample(drawn, 33));
  // Chords of equal arcs of a circle are equal; the drawing itself deviates by its sagitta, 1e-6.
  EXPECT_LT(lengths.maxCoeff() - lengths.minCoeff(), 1e-6);
}

TEST(Centroid, IsTheMeanOfTheColumnsInAnyDimension) {
  Points points(3, 2);
  points << 0, 2, 1, 3, -4, 4;
  EXPECT_EQ(centroid(points), Eigen::Vector3d(1, 2, 0));
  EXPECT_EQ(centroid(shape_of(points)), Eigen::Vector3d(0, 0, 0));
}

}  // namespace
}  // namespace nuno
