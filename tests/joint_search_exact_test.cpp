// The joint search on objectives whose answers, and the way to them, are known exactly.

#include <nuno/joint_search.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace nuno {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// An objective of log α, with derivatives by hand or none.
struct LogFunction {
  std::function<double(const Vector& x)> error;
  std::function<Vector(const Vector& x)> derivative;
};

Vector logs(const Gains& gains) {
  const std::vector<double> groups = gains.groups();
  return Eigen::Map<const Vector>(groups.data(), gains.count()).array().log();
}

JointObjective objective_of(const LogFunction& f, bool has_derivatives) {
  JointObjective objective;
  objective.errors = [f](std::span<const Gains> all) {
    std::vector<double> errors;
    for (const Gains& gains : all) errors.push_back(f.error(logs(gains)));
    return errors;
  };
  if (!has_derivatives) return objective;
  objective.samples = [f](std::span<const Gains> all) {
    std::vector<ErrorSample> samples;
    for (const Gains& gains : all) {
      const Vector x = logs(gains);
      ErrorSample& sample = samples.emplace_back();
      sample.error = f.error(x);
      const Vector derivative = f.derivative(x);
      for (Index k = 0; k < x.size(); ++k) {
        sample.derivatives.push_back({derivative[k] / std::exp(x[k]), {}});
      }
    }
    return samples;
  };
  return objective;
}

/// (x − a)² + (y − b)² + (x − a)·(y − b), over 1.
LogFunction bowl_about(double a, double b) {
  return {[=](const Vector& x) {
            const double u = x[0] - a, v = x[x.size() - 1] - b;
            return 1 + u * u + v * v + u * v;
          },
          [=](const Vector& x) -> Vector {
            const double u = x[0] - a, v = x[x.size() - 1] - b;
            if (x.size() == 1) return Vector::Constant(1, 3 * (u + v));
            return Eigen::Vector2d(2 * u + v, 2 * v + u);
          }};
}

// On the bound u₀ of one axis, the other's best is v = −u₀/2.
TEST(JointSearch, FindsTheBestOnABoundThatHoldsOneGain) {
  constexpr double reach = 3;  // bounds at e^∓3
  for (const bool has_derivatives : {true, false}) {
    for (const double side : {-1, 1}) {
      const LogFunction bowl = bowl_about(4 * side, 0.5 * side);
      JointObjective objective = objective_of(bowl, has_derivatives);
      objective.largest_gain = std::exp(reach);
      const JointSearchOptions options = {.smallest_gain = std::exp(-reach)};
      const JointSearchSummary found =
          joint_search(objective, {1, bowl.error(Vector::Zero(1))}, options);
      const Vector best = logs(found.stages.back().gains);
      ASSERT_EQ(best.size(), 2);
      EXPECT_NEAR(best[0], side * reach, 1e-12);
      // The error's tolerance of 1e-6 is one of 1e-3 in log α; a difference is as wide as 0.01.
      EXPECT_NEAR(best[1], side, 2e-3) << side << has_derivatives;
      EXPECT_EQ(found.status, OptimizeStatus::converged);
    }
  }
}

// E = 1 + u⁴ + c·(v − u/2)⁴: where the curvature vanishes, what BFGS has learnt of it misleads, and
// a descent has to begin anew.
TEST(JointSearch, GoesDownToABottomWithoutCurvature) {
  for (const double c : {1, 10, 100}) {
    for (const double a : {-1.2, -0.95, -0.7, -0.45}) {
      for (const double b : {0.3, 0.7, 1.1, 1.5}) {
        const LogFunction flat = {[=](const Vector& x) {
                                    const double u = x[0] - a, v = x[1] - b - u / 2;
                                    return 1 + std::pow(u, 4) + c * std::pow(v, 4);
                                  },
                                  [=](const Vector& x) -> Vector {
                                    const double u = x[0] - a, v = x[1] - b - u / 2;
                                    const double across = 4 * c * std::pow(v, 3);
                                    return Eigen::Vector2d(4 * std::pow(u, 3) - across / 2, across);
                                  }};
        JointObjective objective = objective_of(flat, true);
        objective.largest_gain = 1e6;
        const JointSearchSummary found = joint_search(objective, {1, flat.error(Vector::Zero(2))},
                                                      {.smallest_gain = 1e-6, .valleys = 0});
        EXPECT_LT(found.stages.back().error, 1 + 1e-6);  // its tolerance
      }
    }
  }
}

// A gain that its bound holds says nothing of the way, however steep the error is along it.
TEST(JointSearch, GoesDownAlongABound) {
  constexpr double reach = 3, steep = 1e4;
  for (const bool has_derivatives : {true, false}) {
    for (const double side : {-1, 1}) {
      const LogFunction cliff = {[=](const Vector& x) {
                                   const double v = x[x.size() - 1] - 1;
                                   return 1 + steep * (reach - side * x[0]) + v * v;
                                 },
                                 [=](const Vector& x) -> Vector {
                                   return Eigen::Vector2d(-side * steep, 2 * (x[1] - 1));
                                 }};
      JointObjective objective = objective_of(cliff, has_derivatives);
      objective.largest_gain = std::exp(reach);
      const JointSearchSummary found =
          joint_search(objective, {1, cliff.error(Vector::Zero(1))},
                       {.smallest_gain = std::exp(-reach), .valleys = 0});
      const Vector best = logs(found.stages.back().gains);
      ASSERT_EQ(best.size(), 2);
      EXPECT_NEAR(best[0], side * reach, 1e-12);
      EXPECT_NEAR(best[1], 1, 2e-3) << side << has_derivatives;
    }
  }
}

TEST(JointSearch, TriesNoGainBeyondItsBounds) {
  for (const bool has_derivatives : {true, false}) {
    for (const double side : {-1, 1}) {
      const LogFunction bowl = bowl_about(40 * side, -30 * side);
      JointObjective objective = objective_of(bowl, has_derivatives);
      objective.gain_scale = 0.5;
      objective.largest_gain = 20;
      const auto errors = objective.errors;
      double least = infinity, most = 0;
      objective.errors = [&](std::span<const Gains> all) {
        for (const Gains& gains : all) {
          for (const double gain : gains.groups()) {
            least = std::min(least, gain);
            most = std::max(most, gain);
          }
        }
        return errors(all);
      };
      joint_search(objective, {1, bowl.error(Vector::Zero(1))}, {.smallest_gain = 0.1});
      // It goes as far as it may, either way.
      EXPECT_NEAR(least, 0.1 * 0.5, 1e-12);
      EXPECT_NEAR(most, 20, 1e-12);
    }
  }
}

TEST(JointSearch, StopsWhereTheErrorIsAsGoodAsNone) {
  JointObjective objective = objective_of(bowl_about(1, 1), true);
  objective.negligible = 0.5;
  const JointSearchSummary found = joint_search(objective, {3, 0.5}, {.groups = 3});
  ASSERT_EQ(found.stages.size(), 1u);
  EXPECT_EQ(found.stages[0].gains.rest, 3);
  EXPECT_EQ(found.stages[0].error, 0.5);
  EXPECT_EQ(found.evaluations, 0);
  EXPECT_GT(joint_search(objective, {3, 0.51}).evaluations, 0);
}

}  // namespace
}  // namespace nuno
