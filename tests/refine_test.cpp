#include <nuno/box2d.h>
#include <nuno/native.h>
#include <nuno/refine.h>
#include <nuno/trade_off.h>

#include <gtest/gtest.h>

#include "scene_library.h"

namespace nuno {
namespace {

std::unique_ptr<Backend> on_native(const Problem& problem) { return native::make_backend(problem); }
std::unique_ptr<Backend> on_box2d(const Problem& problem) { return box2d::make_backend(problem); }

/// A figure throw under the damped, moving reference.
Problem morph_problem(std::size_t which) {
  Scene scene = scene_library::figure_throws()[which];
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  return make_problem(scene);
}

/// The same with the target's segments at the cloth's own lengths, so that it is within reach.
Problem reachable(Problem problem) {
  const Points drawn = problem.target;
  Points& target = problem.target;
  for (Index i = 0; i + 1 < target.cols(); ++i) {
    const Eigen::Vector2d direction = (drawn.col(i + 1) - drawn.col(i)).normalized();
    target.col(i + 1) = target.col(i) + problem.chain.rest_length[i] * direction;
  }
  target = shape_of(target).colwise() + centroid(drawn);
  return problem;
}

TEST(ArrivalTangent, IsTheDerivativeByCentralDifferences) {
  for (const Reference reference : {Reference::hold, Reference::morph}) {
    Problem problem = morph_problem(4);
    problem.reference = reference;
    const double gain = 0.3;
    const Eigen::MatrixXd tangent = on_native(problem)->arrival_tangent(gain);
    for (const Index coordinate : {0, 13, 40, 63}) {
      const double d = 1e-4;
      Eigen::VectorXd difference = Eigen::VectorXd::Zero(64);
      const std::pair<double, double> stencil[] = {{-2, 1}, {-1, -8}, {1, 8}, {2, -1}};
      for (const auto& [steps, weight] : stencil) {
        problem.aim_offset = Points::Zero(2, 32);
        problem.aim_offset(coordinate % 2, coordinate / 2) = steps * d;
        difference += weight * rollout(*on_native(problem), gain).final.reshaped() / (12 * d);
      }
      problem.aim_offset.resize(0, 0);
      // Fourth-order differences over 1e-4 m: d⁴ of fifth derivatives, and rounding 1e-13/1e-4.
      EXPECT_LT((tangent.col(coordinate) - difference).norm(), 1e-6 * difference.norm())
          << coordinate;
    }
  }
}

TEST(Refine, ArrivesExactlyWhereTheTargetIsWithinReach) {
  for (const std::size_t which : {0u, 4u, 7u, 15u}) {
    const Problem problem = reachable(morph_problem(which));
    const RefineSummary summary = refine(problem, 5, on_native, on_native);
    EXPECT_TRUE(summary.converged) << summary.reason;
    EXPECT_LT(summary.flight.error.mean, 1e-9 * problem.chain.length);
    EXPECT_GT(summary.error_before, 1e-4);
  }
}

TEST(Refine, ComesNearerToATargetOutOfReach) {
  const Problem problem = morph_problem(7);  // a Z: its corners cut segments short
  const RefineSummary summary = refine(problem, 5, on_native, on_native);
  EXPECT_FALSE(summary.converged);
  EXPECT_LT(summary.flight.error.mean, 0.5 * summary.error_before);
}

TEST(Refine, CarriesOverToTheOtherEngineAndIsCorrectedThere) {
  Problem problem = reachable(morph_problem(4));
  const double length = problem.chain.length;
  problem.aim_offset = refine(problem, 5, on_native, on_native).aim_offset;
  EXPECT_LT(rollout(*on_box2d(problem), 5).error.mean, 1e-2 * length);
  const RefineSummary corrected =
      refine(problem, 5, on_box2d, on_native, {.tolerance = 1e-5, .rounds = 3});
  EXPECT_LT(corrected.flight.error.mean, 1e-3 * length);
  EXPECT_LE(corrected.rollouts, 12);
}

TEST(Refine, LeavesTheCentroidWhereItWas) {
  const Problem problem = reachable(morph_problem(0));
  EXPECT_LT(refine(problem, 2, on_native, on_native).flight.error.centroid, 1e-10);
}

TEST(TradeOff, FallsInErrorAsItRisesInEffort) {
  const auto backend = on_native(morph_problem(0));
  const std::vector<TradeOffPoint> curve = trade_off(*backend, 24);
  ASSERT_GT(curve.size(), 5u);
  EXPECT_EQ(curve.front().gain, 0);
  for (std::size_t i = 1; i < curve.size(); ++i) {
    EXPECT_LT(curve[i].error, curve[i - 1].error);
    EXPECT_GT(curve[i].effort, curve[i - 1].effort);
  }
}

TEST(TradeOff, LeavesOutWhatIsBeatenInBothAndWhatDiverged) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<TradeOffPoint> curve = best_trades({{.gain = 0, .error = 5, .effort = 0},
                                                        {.gain = 1, .error = 3, .effort = 2},
                                                        {.gain = 2, .error = 4, .effort = 3},
                                                        {.gain = 3, .error = 3, .effort = 4},
                                                        {.gain = 4, .error = 2, .effort = 6},
                                                        {.gain = 5, .error = 1, .effort = 6},
                                                        {.gain = 6, .error = 4.5, .effort = 1},
                                                        {.gain = 7, .error = infinity, .effort = 0},
                                                        {.gain = 8, .error = 6, .effort = 0}});
  std::vector<double> gains;
  for (const TradeOffPoint& point : curve) gains.push_back(point.gain);
  EXPECT_EQ(gains, (std::vector<double>{0, 6, 1, 5}));
}

TEST(TradeOff, FindsTheLeastEffortWithinAnErrorLimit) {
  const auto backend = on_native(morph_problem(0));
  const std::vector<TradeOffPoint> curve = trade_off(*backend, 24);
  const double limit = 0.01;
  const std::optional<TradeOffPoint> point = least_effort(*backend, curve, limit);
  ASSERT_TRUE(point);
  EXPECT_LE(point->error, limit);
  EXPECT_NEAR(point->error, limit, 1e-6);  // no more effort than that takes
  EXPECT_EQ(rollout(*backend, point->gain).error.mean, point->error);
  EXPECT_FALSE(least_effort(*backend, curve, 1e-9));
}

TEST(TradeOff, FindsTheLeastErrorWithinAnEffortLimit) {
  const auto backend = on_native(morph_problem(0));
  const std::vector<TradeOffPoint> curve = trade_off(*backend, 24);
  const TradeOffPoint point = least_error(*backend, curve, 0.2);
  EXPECT_LE(point.effort, 0.2);
  EXPECT_NEAR(point.effort, 0.2, 1e-6);
  EXPECT_EQ(least_error(*backend, curve, 1e9).gain, curve.back().gain);
  EXPECT_EQ(least_error(*backend, curve, 0).gain, 0);
}

}  // namespace
}  // namespace nuno
