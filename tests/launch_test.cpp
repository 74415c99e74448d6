#include <nuno/launch.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "sheet_library.h"

namespace nuno {
namespace {

const Points from = Points{{0.0, 0.5, 1.0}, {1.0, 1.2, 0.7}};
const Points to = Points{{3.0, 2.5, 3.1}, {1.5, 0.2, 2.0}};

/// Where a particle is after `t` of linear drag κ: the integral of m·v̇ = −m·g − k·v, in long double
/// and by its own series for small κ, apart from the library's formula.
Eigen::Vector2d flight(const Eigen::Vector2d& start, const Eigen::Vector2d& velocity, double t,
                       double gravity, double drag_rate) {
  const long double z = static_cast<long double>(drag_rate) * t;
  long double travelled = t, fallen = 0.5L * t * t;  // ∫e^(−κs)ds and ∫∫e^(−κ(s−u))
  if (z > 1e-4L) {
    travelled = -std::expm1(-z) / drag_rate;
    fallen = (t - travelled) / drag_rate;
  } else {
    travelled = t * (1 - z / 2 + z * z / 6);
    fallen = static_cast<long double>(t) * t * (0.5L - z / 6 + z * z / 24);
  }
  return {static_cast<double>(start.x() + velocity.x() * travelled),
          static_cast<double>(start.y() + velocity.y() * travelled - gravity * fallen)};
}

class BallisticLaunch : public testing::TestWithParam<double> {};

TEST_P(BallisticLaunch, BringsALoneParticleToItsTarget) {
  const double arrival_time = 1.3;
  const double gravity = 9.8;
  const double drag_rate = GetParam() / arrival_time;
  const Points velocities = ballistic_launch(from, to, arrival_time, gravity, drag_rate);
  for (Index i = 0; i < from.cols(); ++i) {
    const Eigen::Vector2d end =
        flight(from.col(i), velocities.col(i), arrival_time, gravity, drag_rate);
    // A few roundings of coordinates of order 1; velocities grow with z, and their rounding too.
    EXPECT_LT((end - to.col(i)).norm(), 1e-14 * (4 + GetParam())) << "z = " << GetParam();
  }
}

INSTANTIATE_TEST_SUITE_P(DragFromNoneToSevenHundredTimeConstants, BallisticLaunch,
                         testing::Values(0, 1e-300, 1e-17, 1e-9, 1e-5, 1e-3, 0.1, 0.49, 0.51, 1, 5,
                                         40, 300, 700));

TEST(BallisticLaunch, IsTheParabolaWithoutDrag) {
  const Points velocities = ballistic_launch(from, to, 2, 9.8, 0);
  EXPECT_EQ(velocities(0, 0), (3.0 - 0.0) / 2);
  EXPECT_DOUBLE_EQ(velocities(1, 0), (1.5 - 1.0) / 2 + 9.8 * 2 / 2);
}

TEST(BallisticLaunch, MissesWithTheTermThatThePaperPrints) {
  // Equation (2) ends in g₀ in print; with g instead of g·t₀ a lone particle does not arrive.
  const double t = 1.3, g = 9.8, rate = 0.5;
  const double decay = 1 - std::exp(-rate * t);
  const double printed = (rate * (to(1, 0) - from(1, 0)) - g / rate * decay + g) / decay;
  const double derived = (rate * (to(1, 0) - from(1, 0)) - g / rate * decay + g * t) / decay;
  EXPECT_NEAR(ballistic_launch(from, to, t, g, rate)(1, 0), derived, 1e-13);
  const Eigen::Vector2d end = flight(from.col(0), {0, printed}, t, g, rate);
  EXPECT_GT(std::abs(end.y() - to(1, 0)), 1);
}

TEST(BallisticLaunch, OnARecurrenceTendsToTheClosedFormAsTheStepShrinks) {
  const double t = 1, g = 9.8, rate = 0.5;
  const Points exact = ballistic_launch(from, to, t, g, rate);
  double last = 0;
  for (const Index steps : {100, 200, 400}) {
    const double h = t / static_cast<double>(steps);
    const double r = 1 - rate * h;  // semi-implicit Euler
    const Points own = ballistic_launch(from, to, g, {h, r, h, r, h}, steps);
    const double gap = (own - exact).norm();
    EXPECT_GT(gap, 0);
    if (last > 0) {
      EXPECT_NEAR(last / gap, 2, 0.02);  // first order, as the scheme is
    }
    last = gap;
  }
}

TEST(BallisticLaunch, OnARecurrenceArrivesOnThatRecurrence) {
  const DragRecurrence recurrence{0.01, 0.99, 0.004, 0.98, 0.0098};
  const Index steps = 120;
  const Points velocities = ballistic_launch(from, to, 9.8, recurrence, steps);
  Points x = from, v = velocities;
  for (Index n = 0; n < steps; ++n) {
    v *= n == 0 ? recurrence.r1 : recurrence.r;
    v.row(1).array() -= (n == 0 ? recurrence.q1 : recurrence.q) * 9.8;
    x += recurrence.h * v;
  }
  EXPECT_LT((x - to).norm(), 1e-13);  // 120 roundings
}

class InextensibleLaunch : public testing::Test {
 protected:
  const Points positions = Points{{0.0, 1.0, 1.8, 2.5, 2.6}, {0.0, 0.2, 0.7, 1.5, 2.5}};
  const Points velocities = Points{{1.0, 3.0, -2.0, 0.5, 4.0}, {2.0, -1.0, 0.3, 5.0, -3.0}};
  const Points result = without_stretching(positions, velocities);

  static Vector stretching(const Points& x, const Points& v) {
    Vector rates(x.cols() - 1);
    for (Index i = 0; i + 1 < x.cols(); ++i) {
      rates[i] = (x.col(i + 1) - x.col(i)).normalized().dot(v.col(i + 1) - v.col(i));
    }
    return rates;
  }
};

TEST_F(InextensibleLaunch, StretchesNoSegment) {
  EXPECT_GT(stretching(positions, velocities).cwiseAbs().maxCoeff(), 1);
  EXPECT_LT(stretching(positions, result).cwiseAbs().maxCoeff(), 1e-14);
}

TEST_F(InextensibleLaunch, KeepsTheMomentum) {
  EXPECT_LT((centroid(result) - centroid(velocities)).norm(), 1e-15);
}

TEST_F(InextensibleLaunch, IsTheNearestSuchVelocity) {
  // The change is orthogonal to every velocity field that stretches nothing.
  Points rotation(2, positions.cols());
  rotation.row(0) = -positions.row(1);
  rotation.row(1) = positions.row(0);
  const Points change = velocities - result;
  EXPECT_NEAR(change.cwiseProduct(rotation).sum(), 0, 1e-14);
  EXPECT_NEAR(change.cwiseProduct(result).sum(), 0, 1e-13);
  EXPECT_LT(result.norm(), velocities.norm());
}

TEST_F(InextensibleLaunch, LeavesSuchVelocitiesAlone) {
  EXPECT_LT((without_stretching(positions, result) - result).norm(), 1e-14);
}

TEST(BallisticLaunch, InSpaceArrivesOnTheEnginesRecurrence) {
  const DragRecurrence recurrence{0.01, 0.99, 0.004, 0.98, 0.0098};
  const Points start = Points{{0.0, 0.5}, {1.0, 1.2}, {-0.3, 2.0}};
  const Points end = Points{{3.0, 2.5}, {1.5, 0.2}, {-2.5, 0.1}};
  const Index steps = 120;
  Points x = start, v = ballistic_launch(start, end, 9.8, recurrence, steps);
  for (Index n = 0; n < steps; ++n) {
    v *= n == 0 ? recurrence.r1 : recurrence.r;
    v.row(1).array() -= (n == 0 ? recurrence.q1 : recurrence.q) * 9.8;
    x += recurrence.h * v;
  }
  EXPECT_LT((x - end).norm(), 1e-13);  // 120 roundings
}

/// A sheet of quads and triangles whose masses differ, thrown anyhow.
class InextensibleSheet : public testing::TestWithParam<bool> {
 protected:
  InextensibleSheet() {
    scene_library::FlatMesh mesh = scene_library::grid(1, 0.7, 6, 5);
    mesh.faces[3] = {mesh.faces[3][0], mesh.faces[3][1], mesh.faces[3][2]};
    Points x = mesh.vertices;
    if (is_bent()) {
      x = scene_library::bent(x, 0.4, [](double u) { return 2 * u; });
      x.row(1).array() += 0.1 * (9 * x.row(2).array()).sin();  // both ways
    }
    sheet_ = make_sheet(x, mesh.faces, {}, Rest::initial, 9.8);
    velocities_.resize(3, x.cols());
    for (Index i = 0; i < velocities_.size(); ++i) {
      velocities_.data()[i] = std::sin(1.7 * static_cast<double>(i * i));
    }
    result_ = without_stretching(sheet_, x, velocities_);
  }
  static bool is_bent() { return GetParam(); }

  double stretching(const Points& v) const {
    double largest = 0;
    for (Index e = 0; e < sheet_.edges.cols(); ++e) {
      const Index a = sheet_.edges(0, e), b = sheet_.edges(1, e);
      const Vector along = (sheet_.initial.col(b) - sheet_.initial.col(a)).normalized();
      largest = std::max(largest, std::abs(along.dot(v.col(b) - v.col(a))));
    }
    return largest;
  }
  /// Σ mᵢ·uᵢ·vᵢ.
  double product(const Points& u, const Points& v) const {
    return (u.cwiseProduct(v) * sheet_.relative_mass.asDiagonal()).sum();
  }

  Sheet sheet_;
  Points velocities_, result_;
};

TEST_P(InextensibleSheet, StretchesNoEdge) {
  EXPECT_GT(stretching(velocities_), 1);
  // Two passes with a trace of 1e-10 leave its square, and rounding over it.
  EXPECT_LT(stretching(result_), 1e-9);
}

TEST_P(InextensibleSheet, KeepsTheMomentumAndTheAngularMomentum) {
  EXPECT_LT((sheet_.mass_center(result_) - sheet_.mass_center(velocities_)).norm(), 1e-12);
  for (const auto& axis : {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()}) {
    Points rotation(3, velocities_.cols());
    for (Index i = 0; i < rotation.cols(); ++i) {
      rotation.col(i) = Eigen::Vector3d(axis).cross(sheet_.initial.col(i).head<3>());
    }
    EXPECT_NEAR(product(rotation, velocities_ - result_), 0, 1e-9);
  }
}

TEST_P(InextensibleSheet, ChangesTheVelocitiesTheLeast) {
  const Points change = velocities_ - result_;
  EXPECT_NEAR(product(change, result_), 0, 1e-9);
  EXPECT_LT(product(result_, result_), product(velocities_, velocities_));
  EXPECT_LT((without_stretching(sheet_, sheet_.initial, result_) - result_).norm(), 1e-9);
  if (!is_bent()) {  // across a flat sheet nothing stretches
    EXPECT_LT(change.row(1).norm(), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(FlatAndBent, InextensibleSheet, testing::Bool(),
                         [](const auto& each) { return each.param ? "bent" : "flat"; });

TEST_F(InextensibleLaunch, OfAnyClothAgreesWithTheChainsOnAChain) {
  const Chain chain = make_chain(positions, {}, 9.8);
  EXPECT_LT((without_stretching(chain, positions, velocities) - result).norm(), 1e-13);
}

}  // namespace
}  // namespace nuno
