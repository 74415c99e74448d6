#include <nuno/native.h>
#include <nuno/optimize.h>
#include <nuno/reference_motion.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <cmath>

#include "scene_library.h"

namespace nuno {
namespace {

ChainScene morph_scene(std::string_view from, std::string_view to) {
  ChainScene scene;
  scene.arrival_time = 0.8;
  scene.initial = scene_library::figure(from);
  scene.target = scene_library::figure(to).colwise() + Eigen::Vector2d(2, 1);
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  return scene;
}

/// The motion after all its steps.
ReferenceMotion arrived(const Problem& problem, Index steps) {
  ReferenceMotion motion(problem, problem.arrival_time / static_cast<double>(steps));
  for (Index n = 0; n < steps; ++n) motion.advance();
  return motion;
}

TEST(ReferenceMotion, HoldsTheTargetShapeFromTheStart) {
  ChainScene scene = morph_scene("line", "S");
  scene.reference = Reference::hold;
  const Problem problem = make_problem(scene);
  const ReferenceMotion motion = arrived(problem, 100);
  EXPECT_EQ(motion.shape(), shape_of(problem.target));
  EXPECT_TRUE(motion.velocity().isZero());
}

TEST(ReferenceMotion, MorphsFromTheInitialShapeToTheTarget) {
  for (const Arrival arrival : {Arrival::pass, Arrival::settle}) {
    for (const auto& [from, to] : {std::pair{"line", "S"}, std::pair{"L", "spiral"}}) {
      ChainScene scene = morph_scene(from, to);
      scene.arrival = arrival;
      const Problem problem = make_problem(scene);
      const ReferenceMotion start(problem, 1e-3);
      EXPECT_LT((start.shape() - shape_of(problem.chain().initial)).norm(), 1e-13);
      // A rotation that itself is turned a thousand times collects 1000²/2 roundings of 1e-16.
      EXPECT_LT((arrived(problem, 1000).shape() - shape_of(problem.target)).norm(), 1e-10);
    }
  }
}

TEST(ReferenceMotion, StretchesNothingOnTheWayWhenTheLengthsAgree) {
  Problem problem = make_problem(morph_scene("line", "U"));
  ReferenceMotion motion(problem, 0.8 / 64);
  for (Index n = 0; n < 64; ++n) {
    const double s = static_cast<double>(n) / 64;
    const Vector expected =
        (1 - s) * segment_lengths(problem.chain().initial) + s * segment_lengths(problem.target);
    EXPECT_LT((segment_lengths(motion.shape()) - expected).cwiseAbs().maxCoeff(), 1e-13);
    motion.advance();
  }
}

TEST(ReferenceMotion, BeginsWithItsVelocity) {
  for (const Arrival arrival : {Arrival::pass, Arrival::settle}) {
    ChainScene scene = morph_scene("C", "S");
    scene.arrival = arrival;
    const Problem problem = make_problem(scene);
    const double h = 1e-6;
    const ReferenceMotion start(problem, h);
    ReferenceMotion next = start;
    next.advance();
    // One-sided difference over a microsecond of accelerations of order 100 m/s².
    EXPECT_LT(((next.shape() - start.shape()) / h - start.velocity()).norm(), 1e-3);
    EXPECT_LT(centroid(start.velocity()).norm(), 1e-14);
  }
}

TEST(ReferenceMotion, SettlesWithTheShapeAtRest) {
  ChainScene scene = morph_scene("line", "S");
  const double passing = arrived(make_problem(scene), 1000).velocity().norm();
  scene.arrival = Arrival::settle;
  const double settling = arrived(make_problem(scene), 1000).velocity().norm();
  EXPECT_LT(settling, 2e-3 * passing);  // the mean over the last of 1000 steps
}

TEST(ReferenceMotion, TurnsTheShorterWayOnAverage) {
  // A line to itself turned by 170°, drawn so that the plain difference of directions is 190°.
  ChainScene scene = morph_scene("line", "line");
  const double turn = 170.0 / 180 * 3.141592653589793;
  scene.initial = Points{{0.0, -std::cos(0.1)}, {0.0, -std::sin(0.1)}};
  scene.target = Points{{0.0, std::cos(turn)}, {0.0, std::sin(turn)}};
  const Problem problem = make_problem(scene);
  const ReferenceMotion motion(problem, 1e-3);
  const Points& v = motion.velocity();
  const double rate = (v.col(31) - v.col(0)).norm();  // of a rod of 1 m
  EXPECT_LT(rate * problem.arrival_time, 3.2);
}

TEST(MorphControl, LaunchesAlongTheReference) {
  const Problem problem = make_problem(morph_scene("line", "S"));
  const auto backend = native::make_backend(problem);
  const Rollout flight = rollout(*backend, 0);
  const ReferenceMotion motion(problem, backend->time_step());
  EXPECT_LT((shape_of(flight.launch_velocity) - motion.velocity()).norm(), 1e-12);
}

TEST(MorphControl, ArrivesNearerWithLessEffortThanHold) {
  for (const char* figure : {"C", "S", "Z", "spiral"}) {
    ChainScene scene = morph_scene("line", figure);
    const auto morph = native::make_backend(make_problem(scene));
    scene.reference = Reference::hold;
    scene.damping_ratio = 0;
    const auto hold = native::make_backend(make_problem(scene));
    const OptimizeSummary best = global_search(objective(*hold));
    const Rollout flight = rollout(*morph, 2);
    EXPECT_LT(flight.error.mean, 0.5 * best.error) << figure;
    EXPECT_LT(flight.control_effort, rollout(*hold, best.gain).control_effort) << figure;
  }
}

TEST(MorphControl, GetsNearerWithEveryGain) {
  const auto backend = native::make_backend(make_problem(morph_scene("line", "S")));
  double last = std::numeric_limits<double>::infinity();
  for (const double gain : {0.05, 0.2, 0.8, 3.2, 12.8}) {
    const double error = rollout(*backend, gain).error.mean;
    EXPECT_LT(error, last) << gain;
    last = error;
  }
}

TEST(MorphControl, GivesTheSameBitsInABatch) {
  const auto backend = native::make_backend(make_problem(morph_scene("hook", "spiral")));
  const std::vector<double> gains = {0, 0.1, 0.5, 2, 7};
  const std::vector<double> errors = backend->errors(gains);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    EXPECT_EQ(errors[i], rollout(*backend, gains[i]).error.mean);
  }
}

TEST(MorphControl, KnowsItsDerivative) {
  const auto backend = native::make_backend(make_problem(morph_scene("line", "3")));
  for (const double gain : {0.1, 0.5, 2.0}) {
    const double d = 1e-4 * gain;
    const std::vector<double> around =
        backend->errors(std::vector<double>{gain - 2 * d, gain - d, gain + d, gain + 2 * d});
    const double difference = (around[0] - 8 * around[1] + 8 * around[2] - around[3]) / (12 * d);
    const ErrorSample sample = backend->error_samples({&gain, 1}).front();
    EXPECT_NEAR(sample.derivatives[0].error, difference, 1e-6 * std::abs(difference));
  }
}

}  // namespace
}  // namespace nuno
