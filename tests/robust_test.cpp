#include <nuno/robust.h>

#include <nuno/native.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <array>

#include "scene_library.h"

namespace nuno {
namespace {

TEST(RobustObjective, IsTheMeanErrorOverTheUnperturbedAndThePerturbedStarts) {
  const auto backend = native::make_backend(make_problem(scene_library::straight_to_s()));
  const RobustOptions options{.size = 2e-3, .perturbations = 3};
  const Objective robust = robust_objective(*backend, options);
  EXPECT_FALSE(robust.samples);
  EXPECT_EQ(robust.gain_scale, objective(*backend).gain_scale);
  const std::array gains = {0.0, 0.01, 0.03};
  const std::vector<double> errors = robust.errors(gains);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    double sum = rollout(*backend, gains[i]).error.mean;
    for (const unsigned seed : {1u, 2u, 3u}) {
      const Points start = perturbed(backend->problem(), options.size, seed);
      sum += rollout(*backend, gains[i], {}, start).error.mean;
    }
    EXPECT_NEAR(errors[i], sum / 4, 1e-15) << gains[i];
  }
}

TEST(RobustObjective, MovesACalmOptimumHardly) {
  const auto backend = native::make_backend(make_problem(scene_library::straight_to_s()));
  const OptimizeSummary plain = steepest_descent(objective(*backend));
  const OptimizeSummary robust = steepest_descent(robust_objective(*backend));
  EXPECT_NEAR(robust.gain, plain.gain, 0.05 * plain.gain);
}

TEST(RobustObjective, PrefersAnAnswerThatAPerturbationDoesNotDecide) {
  // The deepest valley of this scene lies where the cloth buckles; another is nearly as deep.
  const auto backend = native::make_backend(make_problem(scene_library::figure_throws()[9]));
  const Objective averaged = robust_objective(*backend);
  const OptimizeSummary plain = global_search(objective(*backend));
  const OptimizeSummary robust = global_search(averaged);
  const auto growth = [&](double gain) { return sensitivity(*backend, rollout(*backend, gain)); };
  const double fragile = averaged.errors({&plain.gain, 1}).front();
  EXPECT_GT(fragile, 1.1 * plain.error);    // a perturbation undoes the answer
  EXPECT_LT(robust.error, 0.95 * fragile);  // on average the other one is better,
  const double unperturbed = rollout(*backend, robust.gain).error.mean;
  EXPECT_NEAR(robust.error, unperturbed, 0.05 * unperturbed);  // with or without perturbation,
  EXPECT_LT(growth(robust.gain), growth(plain.gain));          // and it hangs on less
}

TEST(RobustObjective, HasNoErrorWhereARolloutDiverges) {
  const auto backend = native::make_backend(make_problem(scene_library::straight_to_s()));
  const double absurd = 1e12;
  EXPECT_EQ(robust_objective(*backend).errors({&absurd, 1}).front(),
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace nuno
