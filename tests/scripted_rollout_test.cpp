// A rollout tells exactly what an engine did, whatever it did.

#include <nuno/launch.h>
#include <nuno/rollout.h>
#include <nuno/shape_control.h>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>

#include "scripted_engine.h"

namespace nuno {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// An engine whose cloth has the shape `cross` times a factor after each step.
ScriptedBackend breathing(std::vector<double> factors) {
  const auto steps = static_cast<Index>(factors.size());
  return {problem_of(cross()), steps, [factors = std::move(factors)](const Moment& now) -> Points {
            return factors[static_cast<std::size_t>(now.step - 1)] * cross();
          }};
}

TEST(ScriptedRollout, HasItsFramesBetweenTheSteps) {
  // Seven steps, ten frames per second, and a motion that is linear in time.
  const Points velocity{{1, 2, -3, 5}, {0.5, -1, 4, 7}};
  const ScriptedBackend engine(problem_of(cross()), 7, [&](const Moment& now) -> Points {
    return cross() + static_cast<double>(now.step) / 7 * velocity;
  });
  const Rollout flight = rollout(engine, 0, {.frames_per_second = 10});
  ASSERT_EQ(flight.frame_times.size(), 11u);
  ASSERT_EQ(flight.frame_positions.size(), 11u);
  EXPECT_EQ(flight.frame_times.front(), 0);
  EXPECT_EQ(flight.frame_times.back(), 1);
  EXPECT_EQ(flight.frame_positions.front(), cross());
  EXPECT_EQ(flight.frame_positions.back(), flight.final);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_DOUBLE_EQ(flight.frame_times[i], static_cast<double>(i) / 10);
    const Points expected = cross() + flight.frame_times[i] * velocity;
    EXPECT_LT((flight.frame_positions[i] - expected).norm(), 1e-14) << i;  // of numbers below 10
  }
}

TEST(ScriptedRollout, EndsWithAFrameAtArrivalWhateverTheRate) {
  const ScriptedBackend engine = breathing({1, 1, 1, 1});
  EXPECT_EQ(rollout(engine, 0, {.frames_per_second = 2.5}).frame_times,
            (std::vector<double>{0, 0.4, 0.8, 1}));
  EXPECT_EQ(rollout(engine, 0, {.frames_per_second = 0.1}).frame_times,
            (std::vector<double>{0, 1}));
  EXPECT_TRUE(rollout(engine, 0).frame_times.empty());
}

TEST(ScriptedRollout, HasTheLargestStrainOfTheWholeWay) {
  EXPECT_DOUBLE_EQ(rollout(breathing({1, 1.25, 1.125, 1, 1}), 0).max_strain, 0.25);
  EXPECT_DOUBLE_EQ(rollout(breathing({1, 1.25, 0.5, 1, 1}), 0).max_strain, 0.5);
  EXPECT_DOUBLE_EQ(rollout(breathing({1, 1, 1, 1, 1.75}), 0).max_strain, 0.75);
}

TEST(ScriptedRollout, HasTheStrainOfOneEdgeLongerOrShorterThanTheRest) {
  for (const double length : {0.5, 1.5}) {  // of the first edge alone
    const ScriptedBackend engine(problem_of(cross()), 3, [=](const Moment&) {
      Points x = cross();
      x.col(0) = x.col(1) + length * (x.col(0) - x.col(1)).eval();
      return x;
    });
    EXPECT_DOUBLE_EQ(rollout(engine, 0).max_strain, 0.5) << length;
  }
}

TEST(ScriptedRollout, HasTheLargestTurnOfAnEdgeInAStep) {
  constexpr double turn = 0.3;
  const ScriptedBackend spinning(problem_of(cross()), 5, [](const Moment& now) -> Points {
    return Eigen::Rotation2Dd(turn * static_cast<double>(now.step)).toRotationMatrix() * cross();
  });
  EXPECT_NEAR(rollout(spinning, 0).max_turn, 2 * std::sin(turn / 2), 1e-14);  // a chord
  EXPECT_EQ(rollout(breathing({1, 1, 1}), 0).max_turn, 0);
}

TEST(ScriptedRollout, SumsUpTruncationErrorsWhereTheAccelerationChanges) {
  // x = a·t³ + b·t²: the acceleration changes by 6a·h in every step, and h²/12 of that counts.
  const Points a{{3, 0, 0, 0}, {4, 0, 0, 0}}, b{{1, 2, 3, 4}, {5, 6, 7, 8}};
  for (const Index steps : {3, 10}) {
    const ScriptedBackend engine(problem_of(cross()), steps, [&](const Moment& now) -> Points {
      const double t = static_cast<double>(now.step) / static_cast<double>(steps);
      return cross() + t * t * (t * a + b);
    });
    const double h = 1 / static_cast<double>(steps);
    const double rms = 5.0 / 2;  // one of four particles
    EXPECT_NEAR(rollout(engine, 0).truncation_error * engine.cloth().size,
                static_cast<double>(steps - 2) * h * h / 12 * 6 * rms * h, 1e-14);
  }
}

TEST(ScriptedRollout, DivergesInTheFirstStepWithABadValue) {
  for (const Index bad_step : {1, 4, 9}) {
    for (const double bad : {nan, infinity, -infinity}) {
      const ScriptedBackend engine(problem_of(cross()), 9, [&](const Moment& now) {
        Points x = cross();
        if (now.step >= bad_step) x(1, 2) = bad;
        return x;
      });
      const Rollout flight = rollout(engine, 0, {.frames_per_second = 9});
      EXPECT_EQ(flight.status, RolloutStatus::diverged);
      EXPECT_EQ(flight.diverged_at_step, bad_step);
      EXPECT_EQ(flight.reason, "a particle's position is no longer finite");
      EXPECT_EQ(flight.error.mean, infinity);
      EXPECT_EQ(flight.error.max, infinity);
      EXPECT_EQ(flight.error.centroid, infinity);
      EXPECT_EQ(flight.control_effort, infinity);
      for (const Points& frame : flight.frame_positions) EXPECT_TRUE(frame.allFinite());
    }
  }
}

TEST(ScriptedRollout, DivergesWhereASegmentIsAThousandTimesItsLength) {
  const Rollout long_way = rollout(breathing({1, 1000, 1}), 0);  // a strain of 999
  EXPECT_EQ(long_way.status, RolloutStatus::ok);
  EXPECT_EQ(long_way.diverged_at_step, 0);
  EXPECT_NEAR(long_way.max_strain, 999, 1e-9);
  const Rollout torn = rollout(breathing({1, 1002, 1}), 0);
  EXPECT_EQ(torn.status, RolloutStatus::diverged);
  EXPECT_EQ(torn.diverged_at_step, 2);
  EXPECT_EQ(torn.reason, "a segment is a thousand times its length");
}

TEST(ScriptedRollout, GivesTheEnginesOwnReasonFirst) {
  ScriptedBackend engine = breathing({1, nan});
  engine.last_words = "out of thread";
  EXPECT_EQ(rollout(engine, 0).reason, "out of thread");
}

// A cloth whose shape is n·d off its target's at the beginning of step n = 0, 1 …, under the force
// α·(o − n·d) on every particle: effort² is their mean square.
TEST(ScriptedRollout, HasTheEffortOfEveryStepFromTheFirstToTheLast) {
  for (const double gain : {0.5, 3.0}) {
    Problem problem = problem_of(cross());
    problem.target = 2 * cross();
    const ScriptedBackend engine(problem, 3, [](const Moment& now) -> Points {
      return (1 - 0.25 * static_cast<double>(now.step)) * cross();
    });
    const double squares = 1 + 1.25 * 1.25 + 1.5 * 1.5;  // before the steps; not at arrival
    const double unit = effort_unit(problem);
    EXPECT_DOUBLE_EQ(rollout(engine, gain).control_effort, gain * std::sqrt(squares / 3) / unit);
  }
}

// The same flight: the frames' forces are those that the engine is given, and none after arrival.
TEST(ScriptedRollout, KeepsTheForcesOfItsFrames) {
  Problem problem = problem_of(cross());
  problem.target = 2 * cross();
  std::vector<Points> given;
  const ScriptedBackend engine(problem, 4, [&](const Moment& now) -> Points {
    given.push_back(now.forces);
    return (1 - 0.25 * static_cast<double>(now.step)) * cross();
  });
  const Rollout flight =
      rollout(engine, 0.5, {.frames_per_second = 4, .tail = 0.25, .keeps_forces = true});
  ASSERT_EQ(flight.frame_forces.size(), 6u);
  EXPECT_EQ(flight.frame_forces[0], given[0]);
  for (std::size_t step = 0; step < 4; ++step) {
    EXPECT_EQ(flight.frame_forces[step + 1], given[step]) << step;
  }
  EXPECT_GT(flight.frame_forces[4].norm(), 0);
  EXPECT_TRUE(flight.frame_forces[5].isZero(0));
  EXPECT_TRUE(rollout(engine, 0.5, {.frames_per_second = 4}).frame_forces.empty());
}

TEST(ScriptedRollout, DampsWithTheDampingRatioOfItsProblem) {
  for (const double ratio : {0.0, 0.2, 1.3}) {
    // A shape at rest at its target, that grows by 1/s: all force there is comes of its damping.
    Problem problem = problem_of(cross());
    problem.damping_ratio = ratio;
    const double mass = problem.cloth().particle_mass;
    const double gain = 0.7;
    Points first_force;
    const ScriptedBackend engine(problem, 2, [&](const Moment& now) -> Points {
      if (now.step == 2) first_force = now.forces;
      return 1.5 * cross();  // by half of itself in half a second
    });
    rollout(engine, gain);
    const double damping = 2 * ratio * std::sqrt(gain * mass);
    EXPECT_LT((first_force + (0.5 * gain + damping) * cross()).norm(), 1e-15) << ratio;
  }
}

TEST(ScriptedRollout, PullsWhereOnlyOneGroupHasAGain) {
  Problem problem = problem_of(cross());
  problem.target = 2 * cross();
  const ScriptedBackend engine(problem, 2, [](const Moment&) { return cross(); });
  for (const std::vector<double>& groups : {std::vector<double>{2, 0}, {0, 2}}) {
    const Rollout flight = rollout(engine, Gains::of_groups(groups));
    EXPECT_GT(flight.control_effort, 0);
    // Modes are orthogonal: the squares of both parts' efforts sum to that of the whole.
    const double whole = rollout(engine, 2).control_effort;
    const std::vector<double> others = {groups[1], groups[0]};
    const double other = rollout(engine, Gains::of_groups(others)).control_effort;
    EXPECT_NEAR(std::hypot(flight.control_effort, other), whole, 1e-14 * whole);
  }
}

TEST(ScriptedRollout, FeelsNoForceWithoutAGain) {
  const ScriptedBackend engine(problem_of(cross()), 3, [](const Moment& now) -> Points {
    EXPECT_TRUE(now.forces.isZero(0));
    return 1.1 * now.positions;
  });
  EXPECT_EQ(rollout(engine, Gains::of_groups(std::vector<double>{0, 0})).control_effort, 0);
}

TEST(ScriptedRollout, StartsWithTheLaunchThatItTells) {
  Problem problem = problem_of(cross());
  problem.target = cross().colwise() + Eigen::Vector2d(3, -2);
  // Every particle flies alone.
  const ScriptedBackend engine(problem, 4, [](const Moment& now) -> Points {
    return now.positions + 0.25 * now.velocities;
  });
  const Rollout flight = rollout(engine, 0);
  EXPECT_EQ(flight.launch_velocity, launch(engine));
  EXPECT_LT(flight.error.max, 1e-15);
}

// A correction of the reference by (t/t₀)·δ moves it from the first moment on, the launch with it;
// those of higher powers begin at rest.
TEST(ScriptedRollout, IsLaunchedAlongACorrectionOfTheReference) {
  Problem problem = problem_of(cross());
  problem.arrival_time = 0.5;
  const auto launched = [&] {
    return launch(ScriptedBackend(problem, 4, [](const Moment&) { return cross(); }));
  };
  const Points before = launched();
  problem.reference_correction.assign(4, Points::Zero(2, 4));
  const Points correction = 0.3 * cross();
  problem.reference_correction[0] = correction.colwise() + Eigen::Vector2d(5, 7);  // shape counts
  EXPECT_LT((launched() - before - correction / 0.5).norm(), 1e-14);
  problem.reference_correction[1] = problem.reference_correction[3] = 2 * cross();
  EXPECT_LT((launched() - before - correction / 0.5).norm(), 1e-14);
}

TEST(Gains, OfGroupsHaveTheLargestOfAll) {
  for (std::size_t place = 0; place < 4; ++place) {
    std::vector<double> groups = {1, 2, 3, 1.5};
    groups[place] = 7;
    EXPECT_EQ(Gains::of_groups(groups).largest(), 7) << place;
  }
  EXPECT_EQ(Gains(3).largest(), 3);
  EXPECT_EQ(Gains(0).split(3).largest(), 0);
}

TEST(Sensitivity, IsTheGrowthThatTheEngineGivesAPerturbation) {
  for (const double growth : {0.5, 3.0}) {
    const ScriptedBackend engine(problem_of(cross()), 4, [&](const Moment& now) -> Points {
      return cross() + growth * (now.positions - cross());
    });
    const Rollout flight = rollout(engine, 0);
    // Rounding of a perturbation of 1e-8.
    EXPECT_NEAR(sensitivity(engine, flight) / std::pow(growth, 4), 1, 1e-6);
  }
}

TEST(Backend, HasTheErrorsOfItsRolloutsInTheirOrder) {
  const ScriptedBackend engine = engine_of_error([](double gain) { return 1 / (1 + gain); });
  const std::vector<double> gains = {3, 0.5, 1, 0};
  const std::vector<double> errors = engine.errors(gains);
  ASSERT_EQ(errors.size(), gains.size());
  for (std::size_t i = 0; i < gains.size(); ++i) {
    EXPECT_DOUBLE_EQ(errors[i], 1 / (1 + gains[i]));
  }
}

}  // namespace
}  // namespace nuno
