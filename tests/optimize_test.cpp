#include <nuno/optimize.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nuno {
namespace {

/// An objective from a plain function of the gain.
template <typename Function>
Objective made_of(Function error) {
  Objective objective;
  objective.errors = [error](std::span<const double> gains) {
    std::vector<double> errors;
    for (const double gain : gains) errors.push_back(error(gain));
    return errors;
  };
  return objective;
}

double bowl(double gain) { return 0.5 + (gain - 3) * (gain - 3); }

/// Two valleys: 1 deep at gain 2, 3 deep at gain 50.
double two_valleys(double gain) {
  return 5 - std::exp(-std::pow(gain - 2, 2)) - 3 * std::exp(-std::pow((gain - 50) / 9, 2)) +
         1e-3 * gain;
}

TEST(SteepestDescent, FindsTheBottomOfABowl) {
  const OptimizeSummary summary = steepest_descent(made_of(bowl));
  EXPECT_EQ(summary.status, OptimizeStatus::converged);
  EXPECT_NEAR(summary.gain, 3, 1e-3);  // gain_tolerance 1e-4 of α + scale, a factor of two to spare
  EXPECT_NEAR(summary.error, 0.5, 1e-6);
}

TEST(SteepestDescent, NeverAscends) {
  const OptimizeSummary summary = steepest_descent(made_of(two_valleys));
  ASSERT_GT(summary.history.size(), 3u);
  for (std::size_t i = 1; i < summary.history.size(); ++i) {
    EXPECT_LT(summary.history[i].error, summary.history[i - 1].error);
  }
}

TEST(SteepestDescent, StopsInTheFirstValley) {
  EXPECT_NEAR(steepest_descent(made_of(two_valleys)).gain, 2, 0.01);
}

TEST(SteepestDescent, StaysAtZeroWhereTheErrorRises) {
  const OptimizeSummary summary = steepest_descent(made_of([](double gain) { return 1 + gain; }));
  EXPECT_EQ(summary.gain, 0);
  EXPECT_EQ(summary.error, 1);
  EXPECT_EQ(summary.status, OptimizeStatus::converged);
}

TEST(SteepestDescent, CountsEveryRolloutAndKeepsItsBudget) {
  Index rollouts = 0;
  SteepestDescentOptions options;
  options.largest_evaluations = 5;
  const OptimizeSummary summary = steepest_descent(made_of([&](double gain) {
                                                     ++rollouts;
                                                     return bowl(gain);
                                                   }),
                                                   options);
  EXPECT_EQ(summary.evaluations, rollouts);
  EXPECT_LE(rollouts, options.largest_evaluations + 2);  // a derivative takes two at once
  EXPECT_EQ(summary.status, OptimizeStatus::budget);
  EXPECT_LT(summary.error, bowl(0));  // the best found is still given
}

TEST(SteepestDescent, TurnsBackFromGainsThatDiverge) {
  const OptimizeSummary summary = steepest_descent(made_of(
      [](double gain) { return gain > 2 ? std::numeric_limits<double>::infinity() : bowl(gain); }));
  EXPECT_LE(summary.gain, 2);
  EXPECT_GT(summary.gain, 1.9);
}

TEST(GlobalSearch, FindsTheDeepestValley) {
  const OptimizeSummary summary = global_search(made_of(two_valleys));
  EXPECT_NEAR(summary.gain, 50, 0.05);
  EXPECT_EQ(summary.status, OptimizeStatus::converged);
}

TEST(GlobalSearch, IsNeverWorseThanSteepestDescent) {
  for (const auto& error : {bowl, two_valleys}) {
    EXPECT_LE(global_search(made_of(error)).error, steepest_descent(made_of(error)).error + 1e-12);
  }
}

TEST(GlobalSearch, FindsZeroWhereControlOnlyHurts) {
  EXPECT_EQ(global_search(made_of([](double gain) { return 1 + gain; })).gain, 0);
}

TEST(GlobalSearch, StaysBelowTheLargestGainOfTheEngine) {
  Objective objective = made_of([](double gain) { return 1 / (1 + gain); });
  objective.largest_gain = 7;
  const OptimizeSummary summary = global_search(objective);
  EXPECT_NEAR(summary.gain, 7, 1e-12);
  for (const Evaluation& evaluation : summary.history) EXPECT_LE(evaluation.gain, 7 + 1e-12);
}

TEST(GlobalSearch, SurvivesAnEngineThatAlwaysDiverges) {
  const OptimizeSummary summary =
      global_search(made_of([](double) { return std::numeric_limits<double>::infinity(); }));
  EXPECT_EQ(summary.error, std::numeric_limits<double>::infinity());
}

TEST(GlobalSearch, AsksForManyGainsAtOnce) {
  std::size_t largest = 0;
  Objective objective = made_of(bowl);
  const auto errors = objective.errors;
  objective.errors = [&](std::span<const double> gains) {
    largest = std::max(largest, gains.size());
    return errors(gains);
  };
  global_search(objective);
  EXPECT_GE(largest, 16u);
}

TEST(GlobalSearch, StartsWarmInTheValleyOfTheLastOptimum) {
  Objective objective = made_of(bowl);
  objective.samples = [](std::span<const double> gains) {
    std::vector<ErrorSample> samples;
    for (const double gain : gains) {
      // One particle that arrives E(α) beside its target.
      samples.push_back({bowl(gain),
                         Eigen::Vector2d(bowl(gain), 0),
                         {{2 * (gain - 3), Eigen::Vector2d(2 * (gain - 3), 0)}}});
    }
    return samples;
  };
  const OptimizeSummary cold = global_search(objective);
  const OptimizeSummary warm = global_search(objective, {.warm_start = 2.9});
  EXPECT_NEAR(warm.gain, 3, 1e-3);
  EXPECT_LT(warm.evaluations, cold.evaluations);
  // A valley that has moved away is looked for everywhere.
  EXPECT_NEAR(global_search(objective, {.warm_start = 0.5}).gain, 3, 1e-3);
}

/// An engine with derivatives, by where its particles arrive [2 × N] as a function of u = √α and
/// the derivative of that.
Objective arriving(const std::function<Points(double)>& residual,
                   const std::function<Points(double)>& residual_over_u) {
  const auto mean = [](const Points& points) { return points.colwise().norm().mean(); };
  Objective objective = made_of([=](double gain) { return mean(residual(std::sqrt(gain))); });
  objective.samples = [=](std::span<const double> gains) {
    std::vector<ErrorSample> samples;
    for (const double gain : gains) {
      const double u = std::sqrt(gain);
      ErrorSample sample;
      sample.residual = residual(u);
      sample.error = mean(sample.residual);
      sample.derivatives.emplace_back().residual = residual_over_u(u) / (2 * std::max(u, 1e-9));
      samples.push_back(sample);
    }
    return samples;
  };
  return objective;
}

Objective two_particles_on_cubics() {
  // One crosses its target at u = 2, where E has an edge; the other is near its own.
  return arriving(
      [](double u) {
        return Points{{u - 2, 0.1 * (u - 1)}, {0, 0.02 * std::pow(u, 3)}};
      },
      [](double u) {
        return Points{{1, 0.1}, {0, 0.06 * u * u}};
      });
}

TEST(GlobalSearch, FindsAnEdgeOfTheErrorWhereTheArrivalsAreSmooth) {
  Objective objective = two_particles_on_cubics();
  objective.largest_gain = 100;
  const OptimizeSummary summary = global_search(objective);
  EXPECT_NEAR(summary.gain, 4, 1e-4);
  EXPECT_EQ(summary.status, OptimizeStatus::converged);
  // The cubics are exact: two rounds at most.
  EXPECT_LE(summary.evaluations, 24 + 2 * 8);
}

TEST(GlobalSearch, KeepsToTheLargestGainOfSamples) {
  Objective objective = two_particles_on_cubics();
  objective.largest_gain = 2.25;
  const OptimizeSummary summary = global_search(objective);
  EXPECT_EQ(summary.gain, 2.25);
  for (const Evaluation& evaluation : summary.history) EXPECT_LE(evaluation.gain, 2.25);
}

TEST(GlobalSearch, StepsOverSamplesThatDiverge) {
  Objective objective = two_particles_on_cubics();
  objective.largest_gain = 100;
  const auto samples = objective.samples;
  objective.samples = [=](std::span<const double> gains) {
    std::vector<ErrorSample> result = samples(gains);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      if (gains[i] > 0.5 && gains[i] < 1) {
        result[i] = {};
        result[i].error = std::numeric_limits<double>::infinity();
      }
    }
    return result;
  };
  EXPECT_NEAR(global_search(objective).gain, 4, 1e-4);
}

TEST(GlobalSearch, SaysWhenTheRoundsRanOut) {
  const auto wavy = [](double u) { return Points{{std::sin(40 * u), u - 3}, {0, 0}}; };
  const auto derivative = [](double u) { return Points{{40 * std::cos(40 * u), 1}, {0, 0}}; };
  Objective objective = arriving(wavy, derivative);
  objective.largest_gain = 100;
  EXPECT_EQ(global_search(objective, {.rounds = 1}).status, OptimizeStatus::budget);
}

TEST(GlobalSearch, TakesTheLeastGainWhereNoneIsNeeded) {
  Objective objective = arriving(
      [](double u) {
        return Points{{1e-14 / (1 + u)}, {0}};
      },
      [](double u) {
        return Points{{-1e-14 / (1 + u) / (1 + u)}, {0}};
      });
  objective.negligible = 1e-10;
  const OptimizeSummary summary = global_search(objective);
  EXPECT_EQ(summary.gain, 0);
  EXPECT_EQ(summary.evaluations, 24);
}

}  // namespace
}  // namespace nuno
