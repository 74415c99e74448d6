// An engine of one's own meets the house halfway: two functions, and all the rest is there.

#include <nuno/native.h>
#include <nuno/optimize.h>
#include <nuno/refine.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include "own_engine.h"
#include "scene_library.h"

namespace nuno {
namespace {

Problem damped_morph() {
  ChainScene scene = scene_library::straight_to_s();
  scene.particles = 16;
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  return make_problem(scene);
}

TEST(OwnEngine, KeepsEveryWayToStart) {
  const own::Engine engine(damped_morph(), 1000);
  const Points velocities = Points::Constant(2, 16, 1.0);
  EXPECT_EQ(engine.start(velocities)->positions(), engine.cloth().initial);
  const Points elsewhere = engine.cloth().initial.array() + 1;
  EXPECT_EQ(engine.start(elsewhere, velocities)->positions(), elsewhere);
}

TEST(OwnEngine, HasADefaultForAllThatItNeedNotKnow) {
  const own::Engine engine(damped_morph(), 1000);
  EXPECT_GT(engine.smallest_perturbation(), 0);
  EXPECT_GT(engine.largest_gain(), 0);
  EXPECT_FALSE(engine.has_derivatives());
  EXPECT_EQ(engine.errors(std::vector<double>{0.01}).front(), rollout(engine, 0.01).error.mean);
  const Rollout calm = rollout(engine, tracking_gain(engine));
  EXPECT_GT(sensitivity(engine, calm), 0);
}

TEST(OwnEngine, IsSearchedAndRefinedByTheNameOfItsMaker) {
  const Problem problem = damped_morph();
  const auto engine = own::make_backend(problem);
  const OptimizeSummary best = global_search(objective(*engine));
  EXPECT_LT(best.error, rollout(*engine, 0).error.mean);
  const double gain = tracking_gain(*engine);
  // The target's segments are a little too short for the cloth: it comes near, not onto it.
  const RefineSummary refined = refine(problem, gain, own::make_backend, native::make_backend);
  EXPECT_LT(refined.flight.error.mean, 0.2 * refined.error_before) << refined.reason;
  const RefineSummary on_native = refine(problem, gain, native::make_backend, native::make_backend);
  const RefineSummary transferred =
      transfer(problem, on_native, own::make_backend, native::make_backend);
  EXPECT_LT(transferred.flight.error.mean, 0.2 * transferred.error_before) << transferred.reason;
}

}  // namespace
}  // namespace nuno
