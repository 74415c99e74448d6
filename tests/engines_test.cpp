// Engines by their names, and what each is asked before it flies.

#include <nuno/conditioning.h>
#include <nuno/engines.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <cmath>

#include "scene_library.h"

namespace nuno {
namespace {

SceneFile short_throw(Index particles = 8) {
  ChainScene scene = scene_library::straight_to_s();
  scene.particles = particles;
  return make_scene_file("scene.json", scene);
}

/// What is said; empty if nothing is refused.
template <typename Work>
std::string complaint(Work&& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Engines, AreMadeByTheirNames) {
  const SceneFile file = short_throw();
  for (const std::string_view name : chain_engines) {
    EXPECT_EQ(make_backend(name, file)->name(), name);
    EXPECT_EQ(backend_maker(name, file)(file.problem)->name(), name);
  }
  EXPECT_EQ(complaint([&] { make_backend("bullet", file); }),
            "scene.json: bullet does not fly a chain; those that do: native, box2d");
}

TEST(Engines, TakeStepsThatResolveAStrongGain) {
  const SceneFile file = short_throw();
  for (const std::string_view name : chain_engines) {
    const auto usual = make_backend(name, file);
    EXPECT_EQ(make_backend_for_gain(name, file, usual->largest_gain())->steps(), usual->steps());
    const double strong = 5 * usual->largest_gain();
    const auto finer = make_backend_for_gain(name, file, strong);
    EXPECT_GE(finer->largest_gain(), strong);
    EXPECT_LE(finer->steps(), 4 * usual->steps());  // √5 times as many, by doubling
  }
}

TEST(Engines, HoldTheFramesOfAFlightAndOfWhatStandsAroundIt) {
  SceneFile file = short_throw();
  // A hundred million points of 8 particles.
  file.scene.frames_per_second = 0.99e8 / 8 / file.scene.arrival_time;
  EXPECT_NO_THROW(require_few_frames(file));
  EXPECT_THROW(require_few_frames(file, 0.02 * file.scene.arrival_time), InputError);
  file.scene.frames_per_second *= 0.5;
  EXPECT_NO_THROW(require_few_frames(file, 0.99 * file.scene.arrival_time));
  EXPECT_THROW(require_few_frames(file, 1.05 * file.scene.arrival_time), InputError);
}

TEST(Engines, RefineOnTheEngineThatIsAskedFor) {
  SceneFile file = short_throw();
  const RefineSummary refined = refine_on("box2d", file, {.tolerance = 1e-4, .rounds = 6});
  EXPECT_GT(refined.rollouts, 2);
  Problem corrected = file.problem;
  corrected.reference_correction = refined.reference_correction;
  const auto box2d = backend_maker("box2d", file)(corrected);
  EXPECT_EQ(rollout(*box2d, refined.flight.gains).final, refined.flight.final);
}

TEST(Engines, RefuseToRefineOrToGroupWhatIsTooLargeOrTooSmall) {
  EXPECT_EQ(complaint([] { require_refinable(short_throw(128)); }), "");
  EXPECT_EQ(complaint([] { require_refinable(short_throw(129)); }),
            "scene.json: /particles: 129 is not <= 128, the most to refine");
  for (Index groups = 1; groups <= most_groups; ++groups) {
    const Index fewest = std::max<Index>(3, fewest_particles(groups));
    EXPECT_EQ(complaint([&] { require_groups(short_throw(fewest), groups); }), "");
    if (fewest == 3) continue;
    EXPECT_NE(complaint([&] { require_groups(short_throw(fewest - 1), groups); }), "");
  }
}

TEST(Optimizers, AreRunByTheirNames) {
  Index at_once = 0;  // gains asked together at most
  Objective objective;
  objective.errors = [&](std::span<const double> gains) {
    at_once = std::max(at_once, static_cast<Index>(gains.size()));
    std::vector<double> errors;
    for (const double gain : gains) errors.push_back((gain - 3) * (gain - 3));
    return errors;
  };
  EXPECT_NEAR(run_optimizer("steepest-descent", objective).gain, 3, 1e-3);
  EXPECT_EQ(at_once, 2);  // a difference
  EXPECT_NEAR(run_optimizer("global", objective).gain, 3, 1e-2);
  EXPECT_GT(at_once, 16);
}

TEST(JudgedRollout, IsFlownAtHalfOfItsStepWhereThatIsInDoubt) {
  ChainScene scene = scene_library::straight_to_s();
  scene.launch = Launch::inextensible;
  const SceneFile file = make_scene_file("scene.json", scene);
  for (const std::string_view name : chain_engines) {
    const auto backend = make_backend(name, file);
    const JudgedRollout calm = judged_rollout(*backend, file, 0.1);
    EXPECT_EQ(calm.flight.step_error, std::nullopt) << name;
    EXPECT_EQ(calm.sensitivity, bounded_sensitivity(*backend, calm.flight));

    const JudgedRollout wild = judged_rollout(*backend, file, 30);
    const auto half = at_finer_step(*backend, file, 0.5);
    Rollout again = rollout(*backend, 30);
    measure_step(backend->cloth(), rollout(*half, 30), again);
    EXPECT_GT(again.step_error, 1e-4);
    EXPECT_EQ(wild.flight.step_error, again.step_error) << name;
    EXPECT_EQ(wild.flight.finer_strain, again.finer_strain) << name;
  }
}

}  // namespace
}  // namespace nuno
