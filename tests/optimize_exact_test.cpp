// The optimisers on objectives whose answers, and the way to them, are known exactly.

#include <nuno/optimize.h>
#include <nuno/pareto_front.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scripted_engine.h"

namespace nuno {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Objective objective_of(const std::function<double(double gain)>& error) {
  Objective objective;
  objective.errors = [error](std::span<const double> gains) {
    std::vector<double> errors;
    for (const double gain : gains) errors.push_back(error(gain));
    return errors;
  };
  return objective;
}

// ---- steepest descent --------------------------------------------------------------------------

/// Falls with slope −1 from E = 1 at `start`; from half a gain further on it has fallen by `fall`.
Objective slope_then_plain(double start, double fall) {
  return objective_of([=](double gain) {
    const double along = gain - start;
    return along < 0.5 ? 1 - along : 1 - fall;
  });
}

// The first move is one gain scale long, for which the derivative foretells a fall of 1.
TEST(SteepestDescent, TakesAStepThatFallsByATenthOfWhatTheDerivativePredicts) {
  for (const double start : {0.0, 2.0}) {  // one-sided and central differences
    const OptimizeSummary summary =
        steepest_descent(slope_then_plain(start, 0.11), {.first_gain = start});
    ASSERT_GE(summary.history.size(), 2u);
    EXPECT_NEAR(summary.history[1].gain, start + 1, 1e-9) << start;
  }
}

TEST(SteepestDescent, HalvesAStepThatFallsByLess) {
  for (const double start : {0.0, 2.0}) {
    const OptimizeSummary summary =
        steepest_descent(slope_then_plain(start, 0.09), {.first_gain = start});
    ASSERT_GE(summary.history.size(), 2u);
    // Half of the way falls by 0.09, which is a tenth of 0.5 and more.
    EXPECT_NEAR(summary.history[1].gain, start + 0.5, 1e-9) << start;
    EXPECT_LT(summary.history[1].gain, start + 0.6) << start;
  }
}

TEST(SteepestDescent, GoesByTheDerivativeTimesAFactorThatDoubles) {
  // E = (α − 3)²: from 0, where dE/dα = −6, by 1; then by twice as large a factor, 2/6, times 4.
  // Differences of a parabola are its derivatives to rounding, 1e-16/1e-3.
  const auto parabola = [](double gain) { return (gain - 3) * (gain - 3); };
  const OptimizeSummary up = steepest_descent(objective_of(parabola));
  ASSERT_GE(up.history.size(), 3u);
  EXPECT_NEAR(up.history[1].gain, 1, 1e-9);
  EXPECT_NEAR(up.history[2].gain, 1 + 4.0 / 3, 1e-9);
  // And down: from 5, where it is 4, by 1; then by 2/4 times 2, onto it.
  const OptimizeSummary down = steepest_descent(objective_of(parabola), {.first_gain = 5});
  ASSERT_GE(down.history.size(), 3u);
  EXPECT_NEAR(down.history[1].gain, 4, 1e-9);
  EXPECT_NEAR(down.history[2].gain, 3, 1e-9);
}

TEST(SteepestDescent, MeasuresItsFirstStepInGainScales) {
  Objective objective = objective_of([](double gain) { return 100 - gain; });
  objective.gain_scale = 0.25;
  objective.largest_gain = 3;
  const OptimizeSummary summary = steepest_descent(objective, {.first_step = 2});
  ASSERT_GE(summary.history.size(), 3u);
  EXPECT_NEAR(summary.history[1].gain, 0.5, 1e-9);
  EXPECT_NEAR(summary.history[2].gain, 1.5, 1e-9);
  EXPECT_EQ(summary.gain, 3);
  EXPECT_EQ(summary.status, OptimizeStatus::converged);
}

// ---- global search -----------------------------------------------------------------------------

TEST(GlobalSearch, ScansFromZeroToItsLargestGain) {
  Objective objective = objective_of([](double gain) { return 1 + gain; });
  objective.gain_scale = 0.5;
  const OptimizeSummary summary =
      global_search(objective, {.smallest_gain = 0.1, .largest_gain = 40, .scan = 4, .rounds = 1});
  EXPECT_EQ(summary.history.front().gain, 0);
  EXPECT_NEAR(summary.history.back().gain, 0.5 * 40, 1e-12);
  const auto scanned = [&](double gain) {
    return std::ranges::any_of(summary.history, [&](const Evaluation& at) {
      return std::abs(at.gain - gain) < 1e-12 * gain;
    });
  };
  EXPECT_TRUE(scanned(0.5 * 0.1));
}

TEST(GlobalSearch, FindsAValleyBetweenZeroAndTheSmallestGainByValues) {
  for (const double valley : {0.004, 0.007}) {
    const OptimizeSummary summary = global_search(
        objective_of([=](double gain) { return 1 + std::abs(gain - valley); }), {.rounds = 60});
    EXPECT_NEAR(summary.gain, valley, 1e-4 * valley);
  }
}

TEST(GlobalSearch, FindsAValleyAtEitherEndOfItsScanByValues) {
  Objective objective =
      objective_of([](double gain) { return 1 + std::abs(std::log(gain / 6.99)); });
  objective.largest_gain = 7;
  EXPECT_NEAR(global_search(objective, {.rounds = 60}).gain, 6.99, 1e-4);
}

TEST(GlobalSearch, ByValuesTriesTheSameGainsWhateverTheirUnit) {
  const auto tried_in = [](double unit) {
    Objective objective =
        objective_of([=](double gain) { return 1 + std::abs(std::log((gain / unit + 0.3) / 3)); });
    objective.gain_scale = unit;
    std::vector<double> gains;
    for (const Evaluation& at : global_search(objective, {.rounds = 60}).history) {
      gains.push_back(at.gain / unit);
    }
    return gains;
  };
  for (const double unit : {0x1p-30, 0x1p30}) EXPECT_EQ(tried_in(unit), tried_in(1)) << unit;
}

/// One particle that arrives r(u) > 0 beside its target, u = √α, and tells `slope`(u) for dr/du.
Objective beside_the_target(const std::function<double(double u)>& residual,
                            const std::function<double(double u)>& slope) {
  Objective objective = objective_of([=](double gain) { return residual(std::sqrt(gain)); });
  objective.samples = [=](std::span<const double> gains) {
    std::vector<ErrorSample> samples;
    for (const double gain : gains) {
      const double u = std::sqrt(gain);
      ErrorSample& sample = samples.emplace_back();
      sample.error = residual(u);
      sample.residual = Eigen::Vector2d(residual(u), 0);
      const double derivative = u > 0 ? slope(u) / (2 * u) : 0;
      sample.derivatives.push_back({derivative, Eigen::Vector2d(derivative, 0)});
    }
    return samples;
  };
  return objective;
}

// At gain 0, a derivative along u says nothing of damped control.
TEST(GlobalSearch, LooksForNothingBetweenZeroAndTheSmallestGainByDerivatives) {
  const Objective objective = beside_the_target([](double u) { return 2 + std::cos(20 * u); },
                                                [](double u) { return -20 * std::sin(20 * u); });
  const OptimizeSummary summary = global_search(objective, {.largest_gain = 0.09, .scan = 4});
  EXPECT_NEAR(summary.error, 1, 2e-6);  // its tolerance
  for (const Evaluation& at : summary.history) {
    EXPECT_TRUE(at.gain == 0 || at.gain >= 0.01 * (1 - 1e-9)) << at.gain;
  }
}

/// Between the scanned u = 1 and 2, both with an error of 1, a level dip: what the derivatives
/// foretell of it, and what is found.
struct Dip {
  double foretold, found;
  double at_zero = 1;  ///< the error of launch only
};
OptimizeSummary search_a_dip(const Dip& dip) {
  // The cubic of ends 1, 1 and slopes ∓4·depth has its least value, 1 − depth, in the middle.
  const double slope = 4 * (1 - dip.foretold);
  const auto residual = [=](double u) {
    if (u == 0) return dip.at_zero;
    return std::abs(u - 1.5) < 1e-3 ? dip.found : 1;
  };
  const auto derivative = [=](double u) {
    return std::abs(u - 1) < 1e-9 ? -slope : std::abs(u - 2) < 1e-9 ? slope : 0.0;
  };
  return global_search(beside_the_target(residual, derivative),
                       {.smallest_gain = 1, .largest_gain = 4, .scan = 3});
}

// Half of what a prediction was off is what those beside it are trusted to be off. Here they
// foretell no less than the dip itself: the slope at either end is three times the mean one.
TEST(GlobalSearch, GoesOnWhereWhatPredictionsWereOffMayHideABetterGain) {
  EXPECT_EQ(search_a_dip({.foretold = 0.8, .found = 0.8}).evaluations, 4);
  // Off by 0.15, and nothing is better: on to both sides, where all is as foretold.
  EXPECT_EQ(search_a_dip({.foretold = 0.55, .found = 0.7}).evaluations, 6);
  // A best of 0.07 less may be beaten beside it, one of 0.08 less is not.
  EXPECT_EQ(search_a_dip({.foretold = 0.55, .found = 0.7, .at_zero = 0.63}).evaluations, 6);
  EXPECT_EQ(search_a_dip({.foretold = 0.55, .found = 0.7, .at_zero = 0.62}).evaluations, 4);
}

TEST(Objective, KnowsItsScales) {
  Problem problem = problem_of(cross());
  problem.arrival_time = 2;
  problem.damping_ratio = 0.3;
  ScriptedBackend backend(problem, 3, [](const Moment&) { return cross(); });
  backend.most_gain = 7;
  const Objective errors = objective(backend);
  EXPECT_EQ(errors.gain_scale, problem.cloth().particle_mass / 4);
  EXPECT_EQ(errors.largest_gain, 7);
  EXPECT_EQ(errors.damping_ratio, 0.3);
  EXPECT_EQ(errors.size, problem.cloth().size);
  EXPECT_DOUBLE_EQ(errors.negligible, 1e-10 * problem.cloth().size);
}

/// E swings with the phase φ = √α about 1, by a tenth, and from `noise` on so fast that a radian
/// more moves the arrival by `speed` > 1.
Objective swinging(double noise, double speed, bool has_derivatives) {
  const auto swing = [=](double gain) {
    const double phase = std::sqrt(gain);
    return phase < noise ? std::array{1 + 0.1 * std::sin(phase), 0.1 * std::cos(phase)}
                         : std::array{1 + 0.1 * std::sin(10 * speed * phase), speed};
  };
  Objective objective = objective_of([swing](double gain) { return swing(gain)[0]; });
  objective.damping_ratio = 0;
  if (has_derivatives) {
    objective.samples = [swing](std::span<const double> gains) {
      std::vector<ErrorSample> samples;
      for (const double gain : gains) {
        const auto [error, by_phase] = swing(gain);
        ErrorSample sample;
        sample.error = error;
        sample.residual = Points::Constant(1, 1, error);
        sample.derivatives.resize(1);
        sample.derivatives[0].residual =
            Points::Constant(1, 1, gain > 0 ? by_phase / (2 * std::sqrt(gain)) : 0);
        samples.push_back(std::move(sample));
      }
      return samples;
    };
  }
  return objective;
}

// Eight gains from φ = 10 on are tried, up to √1e5 = 316: φ = 10·31.6^(k/8).
TEST(GainRange, EndsWhereARadianOfPhaseMovesTheArrivalByMoreThanTheCloth) {
  const auto place = [](double k) { return 100 * std::pow(1000, k / 8); };
  for (const bool derivatives : {false, true}) {
    const auto range = [&](double noise, double speed) {
      return gain_range(swinging(noise, speed, derivatives));
    };
    EXPECT_DOUBLE_EQ(range(1e9, 2).largest, 1e5);
    EXPECT_DOUBLE_EQ(range(50, 0.9).calm, 1e5) << "steep, and no noise";
    const GainRange noisy = range(50, 20);  // from φ = 50 on: 42 is calm, 56 is not
    EXPECT_DOUBLE_EQ(noisy.calm, place(3));
    EXPECT_DOUBLE_EQ(noisy.largest, place(4));
    EXPECT_NE(noisy.why.find("noise"), std::string::npos);
    EXPECT_EQ(noisy.evaluations, derivatives ? 8 : 16);
    EXPECT_DOUBLE_EQ(range(1, 20).calm, place(0));
    EXPECT_DOUBLE_EQ(range(1, 20).largest, place(1));
  }
}

TEST(GainRange, OfADampedControlIsTheEngines) {
  Objective objective = swinging(1, 20, true);
  objective.damping_ratio = 0.5;
  objective.largest_gain = 3e4;
  const GainRange range = gain_range(objective);
  EXPECT_EQ(range.largest, 3e4);
  EXPECT_EQ(range.evaluations, 0);
  EXPECT_NE(range.why.find("time step"), std::string::npos);
  objective.damping_ratio = 0.49;
  EXPECT_LT(gain_range(objective).largest, 3e4);
  objective.largest_gain = 99;  // below where E may be noise
  EXPECT_EQ(gain_range(objective).evaluations, 0);
}

TEST(GlobalSearch, TakesTheWholeRangeWhereTheWarmStartIsNoise) {
  const Objective objective = swinging(12, 20, true);
  const OptimizeSummary found = global_search(objective, {.warm_start = 1e4});
  EXPECT_EQ(found.gain, global_search(objective).gain);
  EXPECT_NEAR(found.error, 0.9, 1e-6);  // at φ = 3π/2 or 7π/2
  EXPECT_EQ(found.status, OptimizeStatus::converged);
}

// The swings go on to φ = 316, and one in a hundred turns is a little deeper than the others.
TEST(GlobalSearch, FollowsTheSwingsOfAControlWithoutDamping) {
  constexpr double deepest = 201.5;
  for (const double damping_ratio : {0.0, 0.49}) {
    Objective objective = swinging(1e9, 1, false);
    objective.errors = [=](std::span<const double> gains) {
      std::vector<double> errors;
      for (const double gain : gains) {
        const double phase = std::sqrt(gain);
        const double near = (phase - deepest) / 2;
        errors.push_back(1 - 0.1 * std::cos(phase - deepest) - 0.1 / (1 + near * near));
      }
      return errors;
    };
    objective.damping_ratio = damping_ratio;
    const OptimizeSummary found = global_search(objective);
    EXPECT_EQ(std::abs(std::sqrt(found.gain) - deepest) < 1e-2, damping_ratio == 0)
        << std::sqrt(found.gain);
  }
}

// ---- the Pareto front --------------------------------------------------------------------------

/// The effort of the engine of a known error at one gain.
double effort_at(const ScriptedBackend& engine, double gain) {
  return gain / effort_unit(engine.problem());
}

ParetoPoint point_of(const ScriptedBackend& engine, const std::function<double(double)>& error,
                     double gain) {
  return {gain, error(gain), effort_at(engine, gain)};
}

TEST(ParetoFront, HasLaunchOnlyAndLogSpacedGainsOfTheObjectivesRange) {
  const auto error = [](double gain) { return 5 / (1 + gain); };
  ScriptedBackend engine = engine_of_error(error);
  const double scale = objective(engine).gain_scale;
  engine.most_gain = 10 * scale;
  const std::vector<ParetoPoint> front = pareto_front(engine, 4);
  ASSERT_EQ(front.size(), 5u);
  EXPECT_EQ(front[0].gain, 0);
  for (std::size_t i = 1; i < 5; ++i) {
    const double gain = scale * std::pow(10, static_cast<double>(i) - 3);  // 0.01 … 10
    EXPECT_NEAR(front[i].gain / gain, 1, 1e-12);
    EXPECT_NEAR(front[i].error, error(gain), 1e-12);
    EXPECT_NEAR(front[i].effort / effort_at(engine, gain), 1, 1e-12);
  }
}

TEST(ParetoFront, HasWhatASearchFoundBetweenItsGains) {
  const auto error = [](double gain) {
    const double off = std::abs(gain - 3.3);
    return off < 0.1 ? 0.5 + off : 5 / (1 + gain);
  };
  ScriptedBackend engine = engine_of_error(error);
  engine.most_gain = 10 * objective(engine).gain_scale;
  const std::vector<Evaluation> tried = {
      {.gain = 3.297, .error = 0.503}, {.gain = 3.3, .error = 0.5}, {.gain = 4, .error = 1}};
  const std::vector<ParetoPoint> without = pareto_front(engine, 4);
  const std::vector<ParetoPoint> with = pareto_front(engine, 4, tried);
  EXPECT_FALSE(least_effort(engine, without, 0.5)) << "log-spaced gains miss it";
  EXPECT_TRUE(std::ranges::any_of(with, [](const auto& point) { return point.gain == 3.297; }));
  EXPECT_TRUE(least_effort(engine, with, 0.5));
}

TEST(ParetoFront, LeavesOutWhatTakesMoreAndComesNoNearer) {
  const std::vector<ParetoPoint> front = pareto_optimal(
      {{2, 1, 3}, {0, 5, 0}, {1, 2, 3}, {3, 1, 4}, {4, 0.5, 5}, {5, infinity, 1}, {6, 6, 0.5}});
  std::vector<double> gains;
  for (const ParetoPoint& point : front) gains.push_back(point.gain);
  EXPECT_EQ(gains, (std::vector<double>{0, 2, 4}));
}

TEST(ParetoFront, GivesTheLeastEffortWhoseErrorIsAtTheLimit) {
  const auto error = [](double gain) { return 4 - gain; };
  const ScriptedBackend engine = engine_of_error(error);
  const auto at = [&](double gain) { return point_of(engine, error, gain); };
  const std::vector<ParetoPoint> curve = {at(0), at(1), at(2), at(3)};
  for (const double gain : {0.25, 1.5, 2.75}) {  // between launch only and the first gain, too
    const auto found = least_effort(engine, curve, 4 - gain);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->gain, gain, 1e-8);  // 30 halvings
    EXPECT_LE(found->error, 4 - gain);
  }
  EXPECT_EQ(least_effort(engine, curve, 4)->gain, 0);
  EXPECT_FALSE(least_effort(engine, curve, 0.999));
}

TEST(ParetoFront, GivesTheLeastErrorWhoseEffortIsAtTheLimit) {
  const auto error = [](double gain) { return 4 - gain; };
  const ScriptedBackend engine = engine_of_error(error);
  const auto at = [&](double gain) { return point_of(engine, error, gain); };
  const std::vector<ParetoPoint> curve = {at(0), at(1), at(3)};
  for (const double gain : {0.25, 2.5}) {
    const ParetoPoint found = least_error(engine, curve, effort_at(engine, gain));
    EXPECT_NEAR(found.gain, gain, 1e-8);
    EXPECT_LE(found.effort, effort_at(engine, gain));
  }
  EXPECT_EQ(least_error(engine, curve, effort_at(engine, 5)).gain, 3);
}

// Between two gains of the front the error may rise: at the limit it is then worse than at the
// cheaper of the two.
TEST(ParetoFront, GivesTheBetterOfTheLimitAndTheCheaperPoint) {
  const auto error = [](double gain) { return gain > 1 && gain < 3 ? 9 : 4 - gain; };
  const ScriptedBackend engine = engine_of_error(error);
  const auto at = [&](double gain) { return point_of(engine, error, gain); };
  const ParetoPoint found = least_error(engine, {at(0), at(1), at(3)}, effort_at(engine, 2));
  EXPECT_EQ(found.gain, 1);
  EXPECT_EQ(found.error, 3);
}

TEST(GlobalSearch, SaysWhetherTheBestGainIsTheLargestThatItMayTry) {
  for (const double bottom : {0.5, 3.0}) {  // of E(α), on either side of the largest gain
    Objective objective;
    objective.errors = [bottom](std::span<const double> gains) {
      std::vector<double> errors;
      for (const double gain : gains) errors.push_back(1 + std::abs(gain - bottom));
      return errors;
    };
    objective.largest_gain = 2;
    const OptimizeSummary found = global_search(objective);
    EXPECT_EQ(found.at_largest_gain, bottom > 2) << found.reason;
    EXPECT_EQ(found.reason.find("the best is the largest gain: the time step") != std::string::npos,
              bottom > 2);
  }
}

}  // namespace
}  // namespace nuno
