// The two engines against each other: the same launch, gain and optimiser, one end shape.

#include <nuno/optimize.h>
#include <nuno/rollout.h>
#include <nuno/scene_file.h>

#include <fmt/format.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "engines.h"
#include "scene_library.h"

namespace nuno {
namespace {

/// Mean gap of the end shapes of both engines at one gain, centroids aligned, over L.
double shape_gap(const Problem& problem, double gain, std::optional<double> box2d_step) {
  const Points native = rollout(*native::make_backend(problem), gain).final;
  const Points box2d =
      rollout(*box2d::make_backend(with_time_step(problem, box2d_step)), gain).final;
  return shape_difference(native, box2d).mean / problem.chain().size;
}

Problem inextensible_s_curve() {
  return make_problem(
      std::get<ChainScene>(read_scene(NUNO_SCENES "/s-curve-32-inextensible.json")));
}

TEST(CrossCheck, BothEnginesEndInOneShapeAtTheBestGain) {
  const Problem problem = inextensible_s_curve();
  EXPECT_LT(shape_gap(problem, 0.0175, std::nullopt), 5e-4);
}

TEST(CrossCheck, TheGapShrinksWithTheStepOfBox2d) {
  // A throw of the family that swings fast enough to show the step; a calm one is at 1e-5 from the
  // first, which is rounding.
  ChainScene scene = scene_library::family_member(31);
  scene.cloth.stretch_stiffness = 2e5;
  const Problem problem = make_problem(scene);
  const double t0 = problem.arrival_time, gain = 0.0553;
  const Points native =
      rollout(*native::make_backend(with_time_step(problem, t0 / 25600)), gain).final;
  const auto gap = [&](double steps) {
    const auto box2d = box2d::make_backend_with(
        {.velocity_iterations = 32, .position_iterations = 4}, with_time_step(problem, t0 / steps));
    return shape_difference(native, rollout(*box2d, gain).final).mean / problem.chain().size;
  };
  // Second order: half the step, a quarter of the gap.
  const double coarse = gap(1000), middle = gap(2000), fine = gap(4000);
  EXPECT_LT(middle, 0.5 * coarse);
  EXPECT_LT(fine, 0.7 * middle);
  EXPECT_LT(fine, 2e-4);
}

/// Flies a damped morph, which both engines resolve well, on both at their default steps: they end
/// in one shape, in the place that was asked for, and Box2D takes its t₀/1000.
void expect_one_answer(const Problem& problem, const std::string& which) {
  const auto box2d = box2d::make_backend(problem);
  const Rollout mine = rollout(*native::make_backend(problem), 0.5);
  const Rollout other = rollout(*box2d, 0.5);
  const double size = problem.chain().size;
  EXPECT_EQ(box2d->steps(), 1000) << which;
  EXPECT_LT(shape_difference(mine.final, other.final).mean, 5e-5 * size) << which;
  EXPECT_LT(other.error.centroid, 1e-9 * size) << which;
}

TEST(CrossCheck, NeitherDistanceNorHeightNorTimeTakesStepsOrPrecisionFromBox2d) {
  ChainScene scene = std::get<ChainScene>(read_scene(NUNO_SCENES "/s-curve-32-inextensible.json"));
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  for (const double farther : {0.0, 10.0, 1e2, 1e3, 1e4}) {
    ChainScene far = scene;
    far.target.row(0).array() += farther;
    expect_one_answer(make_problem(far), fmt::format("{} m farther", farther));
  }
  ChainScene high = scene;
  high.arrival_time = 60;  // kilometres up
  expect_one_answer(make_problem(high), "60 s");
}

TEST(CrossCheck, NeitherSizeNorDampingTakesManyStepsOrThePlaceFromBox2d) {
  for (const double size : {1e-1, 1.0, 1e1, 1e3}) {
    for (const double damping : {0.0, 1e-3, 1e-2}) {
      ChainScene scene = scene_library::straight_to_s();
      scene.initial *= size;
      scene.target *= size;
      scene.cloth.hinge_damping = damping;
      const auto box2d = box2d::make_backend(make_problem(scene));
      if (box2d->steps() > 3000) continue;  // 10 cm with a damping of 1e-2
      const Rollout flight = rollout(*box2d, 0);
      EXPECT_EQ(flight.status, RolloutStatus::ok) << size << " m, " << damping;
      EXPECT_LT(flight.error.centroid, 1e-9 * box2d->cloth().size) << size << " m, " << damping;
    }
  }
}

TEST(CrossCheck, EachEngineFindsTheSameFirstValley) {
  const Problem problem = inextensible_s_curve();
  const auto native = native::make_backend(problem);
  const auto box2d = box2d::make_backend(problem);
  const OptimizeSummary a = steepest_descent(objective(*native));
  const OptimizeSummary b = steepest_descent(objective(*box2d));
  EXPECT_NEAR(a.gain, b.gain, 0.02 * a.gain);
  EXPECT_NEAR(a.error, b.error, 1e-3 * problem.chain().size);
}

TEST(CrossCheck, TheOtherEnginesBestGainCostsLittle) {
  const Problem problem = inextensible_s_curve();
  const auto native = native::make_backend(problem);
  const auto box2d = box2d::make_backend(problem);
  const OptimizeSummary a = steepest_descent(objective(*native));
  const OptimizeSummary b = steepest_descent(objective(*box2d));
  EXPECT_LT(rollout(*native, b.gain).error.mean, 1.02 * a.error);
  EXPECT_LT(rollout(*box2d, a.gain).error.mean, 1.02 * b.error);
}

TEST(CrossCheck, GlobalSearchIsNeverWorseThanSteepestDescent) {
  for (const auto& entry : std::filesystem::directory_iterator(NUNO_SCENES)) {
    if (entry.path().extension() != ".json") continue;
    auto scene = std::get<ChainScene>(read_scene(entry.path().string()));
    const Problem problem = make_problem(scene);
    for (const bool box2d : {false, true}) {
      if (box2d && problem.chain().particles() > 32) continue;  // for the test's time
      const auto backend = box2d ? box2d::make_backend(problem) : native::make_backend(problem);
      const Objective errors = objective(*backend);
      EXPECT_LE(global_search(errors).error,
                steepest_descent(errors).error + 1e-6 * problem.chain().size)
          << scene.name << " on " << backend->name();
    }
  }
}

}  // namespace
}  // namespace nuno
