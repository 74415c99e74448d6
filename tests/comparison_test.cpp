// Two engines side by side, of which every error is known.

#include <nuno/comparison.h>
#include <nuno/conditioning.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>

#include "scripted_engine.h"

namespace nuno {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double best_at_one(double gain) { return 0.25 + (gain - 1) * (gain - 1); }
double best_at_two(double gain) { return 0.5 + (gain - 2) * (gain - 2); }

TEST(CompareEngines, HasEveryNumberOfBothInItsPlace) {
  const ScriptedBackend first = engine_of_error(best_at_one);
  const ScriptedBackend second = engine_of_error(best_at_two);
  std::atomic<int> rollouts = 0;
  const Comparison found =
      compare_engines("name", first, second, {.before_rollout = [&] { ++rollouts; }});
  const double length = first.cloth().size, unit = effort_unit(first.problem());
  ASSERT_FALSE(found.divergence);
  EXPECT_EQ(found.scene, "name");
  EXPECT_EQ(found.cloth_length, length);
  EXPECT_EQ(found.launch, Launch::ballistic);

  const auto& [one, two] = found.rows;
  EXPECT_EQ(one.backend, "scripted");
  EXPECT_DOUBLE_EQ(one.launch_only_error, best_at_one(0));
  EXPECT_DOUBLE_EQ(two.launch_only_error, best_at_two(0));
  EXPECT_NEAR(one.gain, 1, 0.01);
  EXPECT_NEAR(two.gain, 2, 0.01);
  EXPECT_NEAR(one.error.mean, best_at_one(one.gain), 1e-12);
  EXPECT_NEAR(two.error.mean, best_at_two(two.gain), 1e-12);
  EXPECT_NEAR(one.control_effort, one.gain / unit, 1e-12 / unit);
  EXPECT_NEAR(one.error_with_the_other_gain, best_at_one(two.gain), 1e-12);
  EXPECT_NEAR(two.error_with_the_other_gain, best_at_two(one.gain), 1e-12);
  // Both miss by the same pattern; at the first one's gain they differ by as much as the errors do.
  const double apart = best_at_two(one.gain) - best_at_one(one.gain);
  EXPECT_NEAR(found.shape_difference.mean, apart / length, 1e-12);
  EXPECT_NEAR(found.shape_difference.max, apart / length, 1e-12);

  ASSERT_EQ(found.curve_gains.size(), 65u);
  EXPECT_EQ(found.curve_gains[0], 0);
  for (std::size_t i = 0; i < found.curve_gains.size(); ++i) {
    const double gain = found.curve_gains[i];
    EXPECT_NEAR(found.curve_errors[0][i], best_at_one(gain), 1e-11);
    EXPECT_NEAR(found.curve_errors[1][i], best_at_two(gain), 1e-11);
    EXPECT_NEAR(found.curve_efforts[1][i], gain / unit, 1e-12 * gain / unit);
    EXPECT_EQ(found.curve_sensitivity[i], 0);  // they forget how they started
    EXPECT_GT(found.curve_strain[i], 0);
    // 1, 10⁻²: log-spaced.
    if (i > 1) {
      EXPECT_NEAR(std::log(gain / found.curve_gains[i - 1]),
                  std::log(found.curve_gains.back() / found.curve_gains[1]) / 63, 1e-12);
    }
  }
  // Launch only, the best, its twin, the other's best; and the curves with the first one's twins.
  EXPECT_EQ(rollouts, 2 * 4 + 3 * 65);
}

TEST(CompareEngines, EndsWithTheFirstRolloutThatDiverges) {
  const ScriptedBackend calm = engine_of_error(best_at_one);
  const ScriptedBackend wild =
      engine_of_error([](double gain) { return gain > 0.5 && gain < 1.5 ? nan : 1 + gain; });
  EXPECT_TRUE(compare_engines("", calm, wild).divergence);  // at the calm one's best
  EXPECT_TRUE(compare_engines("", calm, engine_of_error([](double) { return nan; })).divergence);
  const ScriptedBackend beyond =
      engine_of_error([](double gain) { return gain > 2 ? nan : best_at_one(gain); });
  const Comparison whole = compare_engines("", calm, beyond);
  EXPECT_FALSE(whole.divergence);  // on the curve alone: infinite there
  EXPECT_EQ(whole.curve_errors[1].back(), infinity);
  EXPECT_EQ(whole.curve_efforts[1].back(), infinity);
  EXPECT_LT(whole.curve_errors[0].back(), infinity);
}

TEST(Spread, IsTheMedianTheNineteenOfTwentyAndTheWorst) {
  const Spread of_five = spread({4, 1, 5, 2, 3});
  EXPECT_EQ(of_five.median, 3);
  EXPECT_EQ(of_five.most, 5);  // the nearest of the values to place 3.8 from 0
  EXPECT_EQ(of_five.worst, 5);
  std::vector<double> many;
  for (int i = 40; i >= 0; --i) many.push_back(i);
  EXPECT_EQ(spread(many).median, 20);
  EXPECT_EQ(spread(many).most, 38);
  EXPECT_EQ(spread(many).worst, 40);
  EXPECT_EQ(spread({}).worst, 0);
}

/// A calm comparison with a gap and two points of a curve.
Comparison calm() {
  Comparison comparison;
  comparison.cloth_length = 2;
  comparison.launch = Launch::inextensible;
  comparison.rows[0].error.mean = 0.5;
  comparison.rows[0].error_with_the_other_gain = 0.55;
  comparison.rows[1].error.mean = 0.4;
  comparison.rows[1].error_with_the_other_gain = 0.6;
  comparison.shape_difference = {.mean = 1e-4, .max = 1};
  comparison.curve_gains = {0, 1};
  comparison.curve_errors = {std::vector<double>{0.5, 1e-3}, {0.5, 1e-3}};
  comparison.curve_efforts = comparison.curve_errors;
  comparison.curve_sensitivity = comparison.curve_strain = {0, 0};
  return comparison;
}

TEST(Summary, JudgesWellConditionedScenesThatAreLaunchedWithoutStretching) {
  Comparison fragile = calm(), stretched = calm(), ballistic = calm();
  fragile.rows[0].sensitivity = largest_calm_sensitivity * 1.01;
  stretched.rows[0].max_strain = largest_calm_strain * 1.01;
  ballistic.launch = Launch::ballistic;
  EXPECT_TRUE(is_well_conditioned(calm()));
  EXPECT_FALSE(is_well_conditioned(fragile));
  EXPECT_FALSE(is_well_conditioned(stretched));
  Comparison edge = calm();  // what is at a limit is calm, and the second engine has no say
  edge.rows[0].sensitivity = largest_calm_sensitivity;
  edge.rows[0].max_strain = largest_calm_strain;
  edge.rows[1].sensitivity = infinity;
  EXPECT_TRUE(is_well_conditioned(edge));

  const ComparisonSummary summary = summarize({calm(), fragile, stretched, ballistic, edge});
  EXPECT_EQ(summary.scenes, 5u);
  EXPECT_EQ(summary.well_conditioned, 3u);
  EXPECT_EQ(summary.judged, 2u);
  EXPECT_EQ(summary.gap.median, 1e-4);
  EXPECT_EQ(summary.curve_points, 4u);
  EXPECT_EQ(summary.curve_agreement, 1);
  EXPECT_NEAR(summary.loss.worst, 0.5, 1e-12);   // 0.6 over 0.4
  EXPECT_NEAR(summary.loss.median, 0.5, 1e-12);  // the upper one of 0.1 and 0.5, twice each
  EXPECT_EQ(summarize({}).curve_agreement, 0);
}

// 2 % of the error, or a thousandth of the length, whichever is more.
TEST(Summary, CallsCurvesAgreedWithinTheLargerOfTwoLimits) {
  const auto agreement = [](double error, double other) {
    Comparison comparison = calm();
    comparison.curve_errors[0] = {error, error};
    comparison.curve_errors[1] = {other, error};
    return summarize({comparison}).curve_agreement;
  };
  EXPECT_EQ(agreement(0.5, 0.5099), 1);
  EXPECT_EQ(agreement(0.5, 0.5101), 0.5);
  EXPECT_EQ(agreement(0.5, 0.4901), 1);
  EXPECT_EQ(agreement(0.5, 0.4899), 0.5);
  EXPECT_EQ(agreement(0.01, 0.0119), 1);
  EXPECT_EQ(agreement(0.01, 0.0121), 0.5);
  EXPECT_EQ(agreement(0.01, infinity), 0.5);
  Comparison fragile_there = calm();
  fragile_there.curve_errors[1][0] = infinity;
  fragile_there.curve_sensitivity[0] = infinity;
  EXPECT_EQ(summarize({fragile_there}).curve_points, 1u);
  EXPECT_EQ(summarize({fragile_there}).curve_agreement, 1);
}

TEST(Conditioning, BoundsAGrowthThatLeavesNothingInCommon) {
  const auto growing = [](double growth) {
    const ScriptedBackend engine(problem_of(cross()), 2, [=](const Moment& now) -> Points {
      return cross() + growth * (now.positions - cross());
    });
    return bounded_sensitivity(engine, rollout(engine, 0));
  };
  EXPECT_NEAR(growing(3), 9, 1e-6);
  EXPECT_EQ(growing(1e5), 1e8);  // 10¹⁰, but a perturbation is 10⁻⁸ of the cloth
  EXPECT_EQ(growing(1e8), 1e8);  // torn
}

TEST(Conditioning, CallsAGrowthAboveTenFragile) {
  EXPECT_EQ(fragility(10), "");
  EXPECT_NE(fragility(10.1), "");
  EXPECT_NE(fragility(1679.25).find("grows 1679-fold"), std::string::npos);
  EXPECT_NE(fragility(1e8).find("grows 1e+08-fold"), std::string::npos);
  EXPECT_NE(fragility(infinity), "");
  EXPECT_EQ(fragility(nan), "");
}

TEST(Conditioning, KnowsARolloutWithoutAnAnswer) {
  Rollout flight;
  flight.final = cross();
  EXPECT_FALSE(diverged(flight));
  for (double* number : {&flight.error.mean, &flight.error.max, &flight.error.centroid,
                         &flight.control_effort, &flight.final(1, 2)}) {
    const double right = *number;
    *number = infinity;
    EXPECT_TRUE(diverged(flight));
    *number = right;
  }
  flight.status = RolloutStatus::diverged;
  EXPECT_TRUE(diverged(flight));
}

TEST(Conditioning, CautionsAgainstWhatIsFragileOrElseCoarse) {
  Rollout flight;
  flight.step_error = flight.finer_strain = 0;
  EXPECT_EQ(caution(flight, 1, 0.01), "");
  EXPECT_EQ(caution(flight, 20, 0.01), fragility(20));
  flight.step_error = 0.01;
  EXPECT_EQ(caution(flight, 1, 0.01), coarseness(flight, 0.01));
  EXPECT_EQ(caution(flight, 20, 0.01), fragility(20));
}

TEST(Conditioning, DoubtsAStepThatMayDeserveAWord) {
  const auto is_doubted = [&](double truncation, double growth, double strain, double turn) {
    Rollout flight;
    flight.truncation_error = truncation;
    flight.max_strain = strain;
    flight.max_turn = turn;
    return has_doubtful_step(flight, growth);
  };
  EXPECT_FALSE(is_doubted(2.4e-4, 0.1, 0, 0));
  EXPECT_TRUE(is_doubted(2.6e-4, 0.1, 0, 0));
  EXPECT_FALSE(is_doubted(1.2e-4, 2, 0, 0));
  EXPECT_TRUE(is_doubted(1.3e-4, 2, 0, 0));
  EXPECT_FALSE(is_doubted(2.4e-5, 1e8, 0, 0)) << "fragile, which is a word already";
  EXPECT_TRUE(is_doubted(nan, 1, 0, 0));
  EXPECT_FALSE(is_doubted(0, 1, 0.01, 0.049)) << "strained, but not by turning";
  EXPECT_TRUE(is_doubted(0, 1, 0.01, 0.051));
  EXPECT_FALSE(is_doubted(0, 1, 0.005, 1)) << "too little to care";
  EXPECT_TRUE(is_doubted(0, 1, 0.11, 0)) << "whatever did it";
}

TEST(Conditioning, MeasuresWhatHalfTheStepChanges) {
  // Arrives as a cross of this size, at either step, and elsewhere.
  const auto engine = [](double size) {
    return ScriptedBackend(problem_of(cross()), 5, [size](const Moment&) -> Points {
      return (size * cross()).colwise() + Eigen::Vector2d(7, size);
    });
  };
  const Problem problem = problem_of(cross());
  const Cloth& cloth = problem.cloth();
  Rollout flight = rollout(engine(1), 0);
  measure_step(cloth, rollout(engine(1.25), 0), flight);
  EXPECT_NEAR(flight.step_error.value(), 0.25 / cloth.size, 1e-14);
  EXPECT_EQ(flight.finer_strain, rollout(engine(1.25), 0).max_strain);
  measure_step(cloth, rollout(engine(nan), 0), flight);
  EXPECT_EQ(flight.step_error, infinity);
  EXPECT_EQ(flight.finer_strain, infinity);
}

TEST(Conditioning, SaysWhichStepResolvesACoarseFlight) {
  const auto words = [](double step_error) {
    Rollout flight;
    flight.step_error = step_error;
    flight.finer_strain = 0;
    return coarseness(flight, 0.01);
  };
  EXPECT_EQ(words(1e-3), "");
  EXPECT_EQ(words(nan), "");
  EXPECT_NE(words(0.004).find("0.4 % of L; a time step of 0.005 s resolves it"), std::string::npos);
  EXPECT_NE(words(0.016).find("of 0.0025 s resolves it"), std::string::npos);
  EXPECT_NE(words(infinity).find("or less is worth a try"), std::string::npos);
  EXPECT_EQ(coarseness({}, 0.01), "") << "not measured";
}

TEST(Conditioning, SaysThatAStrainOnTheWayIsTheSteps) {
  const auto words = [](double strain, double finer) {
    Rollout flight;
    flight.step_error = 0;
    flight.max_strain = strain;
    flight.finer_strain = finer;
    return coarseness(flight, 0.01);
  };
  EXPECT_EQ(words(0.005, 0), "") << "too little to care";
  // Of t + 4e, with t + e beside it, 4e is the step's own.
  EXPECT_EQ(words(0.011 + 0.010, 0.011 + 0.0025), "") << "most is the cloth's own";
  EXPECT_NE(words(0.009 + 0.010, 0.009 + 0.0025), "") << "most is the step's";
  EXPECT_NE(words(0.021, 0.01).find("by 1 % only; a time step of 0.005 s"), std::string::npos);
}

TEST(Conditioning, TellsWhereAndWhyARolloutDiverged) {
  const ScriptedBackend engine(problem_of(cross()), 5, [](const Moment& now) -> Points {
    return now.step < 3 ? cross() : nan * cross();
  });
  EXPECT_EQ(divergence_message("file", engine, rollout(engine, 2)),
            "file: diverged on scripted at α = 2 N/m in step 3 of 5: a particle's position is no "
            "longer finite");
}

TEST(Comparison, TellsOfACentroidThatAlignedShapesHide) {
  Comparison comparison;
  comparison.cloth_length = 2;
  comparison.rows[0].backend = "exact";
  comparison.rows[1].backend = "lost";
  comparison.rows[1].error.centroid = 1e-3;
  EXPECT_EQ(centroid_warning(comparison), "");
  comparison.rows[1].error.centroid = 0.5;
  EXPECT_EQ(centroid_warning(comparison), "lost's centroid is 25 % of L from the target's");
}

}  // namespace
}  // namespace nuno
