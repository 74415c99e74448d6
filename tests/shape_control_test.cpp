#include <nuno/error.h>
#include <nuno/shape_control.h>

#include <gtest/gtest.h>

namespace nuno {
namespace {

const Points target = Points{{1.0, 2.0, 4.0}, {0.0, 1.0, -1.0}};
const Points current = Points{{0.0, 1.5, 2.0}, {5.0, 5.0, 4.5}};

Points force_at(const Points& positions, double gain) {
  Points forces;
  shape_control(shape_of(target), positions, gain, forces);
  return forces;
}

TEST(ShapeControl, IsEquationThree) {
  const Eigen::Vector2d difference = centroid(target) - centroid(current);
  const Points forces = force_at(current, 0.7);
  for (Index i = 0; i < 3; ++i) {
    const Eigen::Vector2d expected = 0.7 * (target.col(i) - current.col(i) - difference);
    EXPECT_LT((forces.col(i) - expected).norm(), 1e-15);
  }
}

TEST(ShapeControl, HasNoNetForce) { EXPECT_LT(force_at(current, 3).rowwise().sum().norm(), 1e-14); }

TEST(ShapeControl, DoesNotSeeWhereTheClothIs) {
  const Points moved = current.colwise() + Eigen::Vector2d(100, -50);
  EXPECT_LT((force_at(moved, 1) - force_at(current, 1)).norm(), 1e-13);
}

TEST(ShapeControl, VanishesWhenOnlyThePlaceIsWrong) {
  const Points moved = target.colwise() + Eigen::Vector2d(3, 4);
  EXPECT_LT(force_at(moved, 1).norm(), 1e-15);
}

TEST(ShapeControl, HoldsInThreeDimensions) {
  const Points a = Points{{0.0, 1.0}, {0.0, 0.0}, {0.0, 2.0}};
  const Points b = Points{{5.0, 5.0}, {1.0, 2.0}, {7.0, 7.0}};
  Points forces;
  shape_control(shape_of(a), b, 2, forces);
  EXPECT_LT((forces.col(0) - Eigen::Vector3d(-1, 1, -2)).norm(), 1e-15);
}

TEST(ArrivalError, IsTheMeanDistanceTheWorstAndTheCentroids) {
  const Points a = Points{{0.0, 0.0}, {0.0, 0.0}};
  const Points b = Points{{3.0, 0.0}, {4.0, 1.0}};
  const ArrivalError error = arrival_error(a, b);
  EXPECT_DOUBLE_EQ(error.mean, 3);
  EXPECT_DOUBLE_EQ(error.max, 5);
  EXPECT_DOUBLE_EQ(error.centroid, Eigen::Vector2d(1.5, 2.5).norm());
}

TEST(ShapeDifference, DoesNotSeePlace) {
  const ShapeDifference difference =
      shape_difference(target, target.colwise() + Eigen::Vector2d(7, 8));
  EXPECT_LT(difference.max, 1e-15);
}

TEST(ShapeDamping, PullsVelocitiesTowardsThatOfTheReferenceAndSumsToZero) {
  const Points reference{{0.0, 1.0, -1.0}, {0.5, 0.0, -0.5}};
  const Points velocities{{3.0, 5.0, 1.5}, {1.0, -2.0, 0.5}};
  Points forces = Points::Ones(2, 3);  // what is there already stays
  add_shape_damping(reference, velocities, 0.3, forces);
  const Points expected = 0.3 * (reference - shape_of(velocities));
  EXPECT_LT((forces - Points::Ones(2, 3) - expected).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LT(expected.rowwise().sum().norm(), 1e-15);
}

}  // namespace
}  // namespace nuno
