// What every engine promises, one suite over all of them.

#include <nuno/launch.h>
#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>

#include "engines.h"
#include "scene_library.h"

namespace nuno {
namespace {

using std::numbers::pi;

/// Well-conditioned throws of the library: a gentle one, and two of the family.
std::vector<ChainScene> calm_scenes() {
  std::vector<ChainScene> scenes = {scene_library::straight_to_s(), scene_library::family_member(0),
                                    scene_library::family_member(4)};
  for (ChainScene& scene : scenes) scene.launch = Launch::inextensible;
  return scenes;
}

/// A gain below every calm scene's best one [N/m].
double calm_gain(const Problem& problem) {
  return problem.chain().particle_mass / (problem.arrival_time * problem.arrival_time);
}

class EveryEngine : public testing::TestWithParam<Engine> {
 protected:
  static std::unique_ptr<Backend> make(const ChainScene& scene,
                                       std::optional<double> time_step = std::nullopt) {
    return GetParam().make(make_problem(scene), time_step);
  }
  static double rounding() { return GetParam().rounding; }
};

TEST_P(EveryEngine, FliesAFreeClothByItsOwnRecurrence) {
  ChainScene scene = scene_library::straight_to_s();
  scene.cloth.air_drag = 0.2;
  const auto backend = make(scene);
  const DragRecurrence r = backend->drag_recurrence();
  const Eigen::Vector2d launch_velocity(3, 5);
  const auto cloth = backend->start(launch_velocity.replicate(1, 32));
  const Points none = Points::Zero(2, 32);
  Eigen::Vector2d x(0, 0), v = launch_velocity;
  for (Index n = 0; n < backend->steps(); ++n) {
    cloth->step(none);
    v *= n == 0 ? r.r1 : r.r;
    v.y() -= (n == 0 ? r.q1 : r.q) * scene.gravity;
    x += r.h * v;
    const Points moved = cloth->positions() - backend->problem().chain().initial;
    ASSERT_LT((moved.colwise() - x).colwise().norm().maxCoeff(), rounding()) << "step " << n;
  }
}

TEST_P(EveryEngine, BringsTheCentroidHomeAtEveryGain) {
  for (const ChainScene& scene : calm_scenes()) {
    const auto backend = make(scene);
    for (const double times : {0.0, 1.0, 10.0, 100.0}) {
      const Rollout flight = rollout(*backend, times * calm_gain(backend->problem()));
      EXPECT_LT(flight.error.centroid, rounding()) << scene.name << ", gain × " << times;
    }
  }
}

TEST_P(EveryEngine, KeepsAWholeNumberOfStepsUntilArrival) {
  ChainScene scene = scene_library::straight_to_s();
  scene.arrival_time = 0.777;
  for (const double wish : {1e-3, 3.3e-4, 1e-4}) {
    const auto backend = make(scene, wish);
    EXPECT_LE(backend->time_step(), wish * (1 + 1e-12));
    EXPECT_NEAR(backend->time_step() * static_cast<double>(backend->steps()), 0.777, 1e-12);
  }
}

TEST_P(EveryEngine, GivesTheSameAnswerTwiceAndInThreads) {
  const auto backend = make(scene_library::straight_to_s());
  const double gain = 4 * calm_gain(backend->problem());
  const Points first = rollout(*backend, gain).final;
  std::vector<Points> finals(4);
  {
    std::vector<std::jthread> threads;
    for (Points& final : finals) {
      threads.emplace_back([&] { final = rollout(*backend, gain).final; });
    }
  }
  for (const Points& final : finals) EXPECT_EQ(final, first);
}

TEST_P(EveryEngine, KnowsTheErrorsOfManyGainsAtOnce) {
  const auto backend = make(scene_library::straight_to_s());
  const double unit = calm_gain(backend->problem());
  const std::vector<double> gains = {0, unit, 2 * unit, 5 * unit, 9 * unit};
  const std::vector<double> errors = backend->errors(gains);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    EXPECT_EQ(errors[i], rollout(*backend, gains[i]).error.mean);
  }
}

TEST_P(EveryEngine, SpinsAStraightClothWithoutBendingIt) {
  ChainScene scene = scene_library::straight_to_s();
  scene.gravity = 0;
  scene.cloth.air_drag = 0;
  scene.cloth.stretch_stiffness = 2e5;
  scene.arrival_time = 0.5;
  const auto backend = make(scene);
  const Points& initial = backend->problem().chain().initial;
  const double rate = 4;  // rad/s
  Points velocity = Points::Zero(2, 32);
  velocity.row(1) = rate * shape_of(initial).row(0);
  const auto cloth = backend->start(velocity);
  const Points none = Points::Zero(2, 32);
  for (Index n = 0; n < backend->steps(); ++n) cloth->step(none);
  const double angle = rate * scene.arrival_time;
  const Eigen::Rotation2D<double> turn(angle);
  const Points expected =
      (turn.toRotationMatrix() * shape_of(initial)).colwise() + centroid(initial);
  // The scheme's own error in the phase, (rate·h)² of 2 rad at most, and centrifugal strain
  // M·rate²·L/(8·EA) of 1e-6.
  EXPECT_LT((cloth->positions() - expected).colwise().norm().maxCoeff(), 2e-4 + rounding());
}

TEST_P(EveryEngine, KeepsAngularMomentumInFreeFlight) {
  ChainScene scene = scene_library::family_member(4);
  scene.cloth.air_drag = 0;
  const auto backend = make(scene);
  const auto cloth = backend->start(launch(*backend));
  const Points none = Points::Zero(2, 32);
  // About the centroid, with each half-step velocity taken at the mean of the positions around it.
  const auto spin = [&](const Points& before) {
    const Points arm = shape_of(0.5 * (before + cloth->positions()));
    const Points v = shape_of(cloth->velocities());
    return (arm.row(0).cwiseProduct(v.row(1)) - arm.row(1).cwiseProduct(v.row(0))).sum();
  };
  Points before = cloth->positions();
  cloth->step(none);
  const double first = spin(before);
  const double scale = 32 * 0.1;  // 32 particles at arms of order 0.3 m and speeds of order 1 m/s
  for (Index n = 1; n < backend->steps(); ++n) {
    before = cloth->positions();
    cloth->step(none);
    ASSERT_NEAR(spin(before), first, scale * 30 * rounding()) << "step " << n;
  }
}

TEST_P(EveryEngine, TakesAnAbsurdGainAsAValueNotAsACrash) {
  const auto backend = make(scene_library::straight_to_s());
  for (const double gain : {1e3, 1e9, 1e30, 1e300}) {
    const Rollout flight = rollout(*backend, gain);
    if (flight.status == RolloutStatus::ok) {
      EXPECT_TRUE(flight.final.allFinite());
    } else {
      EXPECT_EQ(flight.error.mean, std::numeric_limits<double>::infinity());
      EXPECT_GT(flight.diverged_at_step, 0);
      EXPECT_FALSE(flight.reason.empty());
    }
  }
}

TEST_P(EveryEngine, StartsFromEveryShapeThatItAccepts) {
  // A hairpin, a fold to 170° and a curled line: no assertion, no bad value.
  const double back = 170 * pi / 180;
  for (const Points& initial :
       {Points{{0.0, 1.0, 0.01}, {0.0, 0.0, 0.02}},
        Points{{0.0, 0.5, 0.5 + 0.5 * std::cos(back)}, {0.0, 0.0, 0.5 * std::sin(back)}}}) {
    ChainScene scene = scene_library::straight_to_s();
    scene.initial = initial;
    try {
      const auto backend = make(scene);
      EXPECT_TRUE(rollout(*backend, 0).final.allFinite());
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("/initial"), std::string::npos);
    }
  }
}

TEST_P(EveryEngine, KeepsFramesAtTheirTimes) {
  const auto backend = make(scene_library::straight_to_s());
  const Rollout flight = rollout(*backend, 0, {.frames_per_second = 24});
  ASSERT_EQ(flight.frame_times.size(), 25u);
  ASSERT_EQ(flight.frame_positions.size(), 25u);
  EXPECT_EQ(flight.frame_positions.front(), backend->problem().chain().initial);
  EXPECT_EQ(flight.frame_positions.back(), flight.final);
  for (std::size_t i = 0; i < 25; ++i) {
    EXPECT_NEAR(flight.frame_times[i], static_cast<double>(i) / 24, 1e-12);
  }
}

// ---- symmetries: a changed scene has the correspondingly changed answer ----------------------

Points final_shape(const Engine& engine, const ChainScene& scene, double gain) {
  return rollout(*engine.make(make_problem(scene), std::nullopt), gain).final;
}

/// How far rounding spreads over a calm flight: sensitivities stay below ten.
constexpr double calm_growth = 10;

TEST_P(EveryEngine, IsBlindToWhereTheSceneLies) {
  for (const ChainScene& scene : calm_scenes()) {
    const double gain = calm_gain(make_problem(scene));
    ChainScene moved = scene;
    const Eigen::Vector2d offset(2, -3);
    moved.initial.colwise() += offset;
    moved.target.colwise() += offset;
    const Points difference = (final_shape(GetParam(), moved, gain).colwise() - offset) -
                              final_shape(GetParam(), scene, gain);
    EXPECT_LT(difference.colwise().norm().maxCoeff(), calm_growth * rounding()) << scene.name;
  }
}

TEST_P(EveryEngine, MirrorsItsAnswerWithTheScene) {
  for (const ChainScene& scene : calm_scenes()) {
    const double gain = calm_gain(make_problem(scene));
    ChainScene mirrored = scene;
    mirrored.initial.row(0) *= -1;
    mirrored.target.row(0) *= -1;
    Points answer = final_shape(GetParam(), mirrored, gain);
    answer.row(0) *= -1;
    EXPECT_LT((answer - final_shape(GetParam(), scene, gain)).colwise().norm().maxCoeff(),
              calm_growth * rounding())
        << scene.name;
  }
}

TEST_P(EveryEngine, TurnsItsAnswerWithASceneWithoutGravity) {
  for (ChainScene scene : calm_scenes()) {
    scene.gravity = 0;
    const double gain = calm_gain(make_problem(scene));
    const Eigen::Matrix2d turn = Eigen::Rotation2D<double>(1.234).toRotationMatrix();
    ChainScene turned = scene;
    turned.initial = turn * scene.initial;
    turned.target = turn * scene.target;
    const Points difference = turn.transpose() * final_shape(GetParam(), turned, gain) -
                              final_shape(GetParam(), scene, gain);
    EXPECT_LT(difference.colwise().norm().maxCoeff(), calm_growth * rounding()) << scene.name;
  }
}

TEST_P(EveryEngine, ReversesItsAnswerWithTheOrderOfParticles) {
  for (const ChainScene& scene : calm_scenes()) {
    const double gain = calm_gain(make_problem(scene));
    ChainScene reversed = scene;
    reversed.initial = scene.initial.rowwise().reverse().eval();
    reversed.target = scene.target.rowwise().reverse().eval();
    const Points answer = final_shape(GetParam(), reversed, gain).rowwise().reverse();
    // Box2D sweeps its joints in order, so reversing it shows what its iterations leave undone.
    const double unsolved = GetParam().sweeps_joints ? 1e-3 : 0;
    EXPECT_LT((answer - final_shape(GetParam(), scene, gain)).colwise().norm().maxCoeff(),
              calm_growth * rounding() + unsolved)
        << scene.name;
  }
}

TEST_P(EveryEngine, ScalesItsAnswerWithLengthTimeAndMass) {
  // By powers of two, so that a double rounds alike.
  const double length = 4, time = 0.5, mass = 8;
  for (const ChainScene& scene : calm_scenes()) {
    const double gain = calm_gain(make_problem(scene));
    ChainScene scaled = scene;
    scaled.initial *= length;
    scaled.target *= length;
    scaled.arrival_time *= time;
    scaled.gravity *= length / (time * time);
    scaled.cloth.mass *= mass;
    scaled.cloth.air_drag *= mass / time;
    scaled.cloth.stretch_stiffness *= mass * length / (time * time);
    scaled.cloth.stretch_damping *= mass * length / time;
    scaled.cloth.hinge_stiffness *= mass * length * length * length / (time * time);
    const Points answer = final_shape(GetParam(), scaled, gain * mass / (time * time)) / length;
    EXPECT_LT((answer - final_shape(GetParam(), scene, gain)).colwise().norm().maxCoeff(),
              calm_growth * rounding())
        << scene.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Engines, EveryEngine,
                         testing::Values(native_engine, box2d_weld_engine, box2d_pair_engine),
                         [](const auto& engine) { return std::string(engine.param.name); });

}  // namespace
}  // namespace nuno
