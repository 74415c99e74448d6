#include <nuno/rollout.h>

#include <nuno/native.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stop_token>
#include <vector>

#include "scene_library.h"

namespace nuno {
namespace {

TEST(Rollout, MeasuresControlEffortInWeights) {
  ChainScene scene = scene_library::straight_to_s();
  const auto backend = native::make_backend(make_problem(scene));
  EXPECT_EQ(rollout(*backend, 0).control_effort, 0);
  // At a tiny gain the flight is that of launch only, so the effort grows in proportion.
  const double one = rollout(*backend, 1e-9).control_effort;
  const double two = rollout(*backend, 2e-9).control_effort;
  EXPECT_GT(one, 0);
  EXPECT_NEAR(two / one, 2, 1e-6);
}

TEST(Rollout, MeasuresControlEffortWithoutGravityToo) {
  ChainScene scene = scene_library::straight_to_s();
  scene.gravity = 0;
  const Problem problem = make_problem(scene);
  EXPECT_DOUBLE_EQ(effort_unit(problem), problem.chain().particle_mass * problem.chain().size);
}

TEST(Rollout, KnowsTheLargestStrainOnTheWay) {
  ChainScene scene = scene_library::straight_to_s();
  scene.launch = Launch::inextensible;
  const double soft = rollout(*native::make_backend(make_problem(scene)), 0.02).max_strain;
  scene.cloth.stretch_stiffness *= 100;
  const double stiff = rollout(*native::make_backend(make_problem(scene)), 0.02).max_strain;
  EXPECT_GT(soft, 1e-6);
  EXPECT_LT(stiff, 0.1 * soft);
}

TEST(Rollout, SaysWhereAndWhyItDiverged) {
  const auto backend = native::make_backend(make_problem(scene_library::straight_to_s()));
  const Rollout flight = rollout(*backend, 1e12);
  EXPECT_EQ(flight.status, RolloutStatus::diverged);
  EXPECT_GT(flight.diverged_at_step, 0);
  EXPECT_LE(flight.diverged_at_step, backend->steps());
  EXPECT_EQ(flight.error.mean, std::numeric_limits<double>::infinity());
}

TEST(Rollout, FliesOnWithoutControlAfterArrival) {
  const auto backend = native::make_backend(make_problem(scene_library::straight_to_s()));
  const Rollout arriving = rollout(*backend, 0.05, {.frames_per_second = 30});
  const Rollout flight = rollout(*backend, 0.05, {.frames_per_second = 30, .tail = 0.5});
  EXPECT_EQ(flight.final, arriving.final);
  EXPECT_EQ(flight.error.mean, arriving.error.mean);
  EXPECT_EQ(flight.control_effort, arriving.control_effort);
  ASSERT_EQ(flight.frame_times.size(), arriving.frame_times.size() + 15);
  EXPECT_EQ(flight.frame_positions[30], flight.final);
  // Internal forces do not move the centroid: it flies on as a lone particle does.
  const DragRecurrence drag = backend->drag_recurrence();
  Eigen::VectorXd x = centroid(flight.final), v = centroid(flight.final_velocity);
  const Eigen::Vector2d g(0, backend->cloth().gravity);
  for (Index n = 0; 2 * n < backend->steps(); ++n) {
    v = drag.r * v - drag.q * g;
    x += drag.h * v;
  }
  EXPECT_NEAR(flight.frame_times.back(), 1.5, 1e-12);
  EXPECT_LT((centroid(flight.frame_positions.back()) - x).norm(), 1e-12);
}

TEST(Rollout, UnderNoControlDoesNotFeelItsArrival) {
  ChainScene scene = scene_library::straight_to_s();
  const auto backend = native::make_backend(make_problem(scene));
  const Rollout flight = rollout(*backend, 0, {.frames_per_second = 40, .tail = 0.25});
  const auto cloth = backend->start(flight.launch_velocity);
  const Points no_forces = Points::Zero(2, backend->cloth().particles());
  for (Index n = 0; 4 * n < 5 * backend->steps(); ++n) cloth->step(no_forces);
  EXPECT_LT((flight.frame_positions.back() - cloth->positions()).norm(), 1e-9);
  EXPECT_EQ(flight.frame_times.back(), 1.25);
}

TEST(Rollout, EndsWhereItIsAskedToStop) {
  ChainScene scene = scene_library::straight_to_s();
  Problem problem = make_problem(scene);
  std::stop_source source;
  problem.stop = source.get_token();
  const auto backend = native::make_backend(problem);
  const std::vector<double> gains(20, 0.01);
  CorrectionDirections directions;
  directions.powers = {1};
  directions.shapes.setOnes(backend->cloth().initial.size(), 1);
  EXPECT_EQ(rollout(*backend, 0.01).status, RolloutStatus::ok);
  source.request_stop();
  EXPECT_THROW(rollout(*backend, 0.01), Stopped);
  EXPECT_THROW(backend->errors(gains), Stopped);
  EXPECT_THROW(backend->error_samples(gains), Stopped);
  EXPECT_THROW(backend->jacobian(0.01, directions), Stopped);
}

TEST(Perturbation, MovesByItsSizeAndStretchesNothing) {
  const Problem problem = make_problem(scene_library::family_member(5));
  const Chain& chain = problem.chain();
  for (const double size : {1e-8, 1e-4}) {
    for (const unsigned seed : {0u, 1u}) {
      const Points moved = perturbed(problem, size, seed);
      const ArrivalError change = arrival_error(moved, chain.initial);
      EXPECT_NEAR(change.mean / (size * chain.size), 1, 0.01);
      EXPECT_LT(change.centroid, 1e-14);
      EXPECT_LT((segment_lengths(moved) - chain.rest_length).cwiseAbs().maxCoeff(), 1e-15);
    }
  }
  EXPECT_GT((perturbed(problem, 1e-4, 0) - perturbed(problem, 1e-4, 1)).norm(), 1e-5);
}

TEST(Sensitivity, IsOneForAClothThatFliesRigidly) {
  // Straight, no bending stiffness, no gravity: a free particle keeps its displacement, but for the
  // segments' tension, which keeps their lengths.
  ChainScene scene = scene_library::straight_to_s();
  scene.target = scene.initial.colwise() + Eigen::Vector2d(2, 0);
  scene.gravity = 0;
  scene.cloth.air_drag = 0;
  scene.cloth.hinge_stiffness = 0;
  const auto backend = native::make_backend(make_problem(scene));
  EXPECT_NEAR(sensitivity(*backend, rollout(*backend, 0)), 1, 0.01);
}

TEST(Sensitivity, TellsAFragileFlightFromACalmOne) {
  const auto backend = native::make_backend(make_problem(scene_library::family_member(1)));
  EXPECT_LT(sensitivity(*backend, rollout(*backend, 0)), 10);
  // The same scene pulled through itself: see the study of the family.
  double worst = 0;
  for (const double gain : {1.0, 1.5, 2.0, 2.5, 3.0}) {
    worst = std::max(worst, sensitivity(*backend, rollout(*backend, gain)));
  }
  EXPECT_GT(worst, 1e3);
}

}  // namespace
}  // namespace nuno
