// What a throw asks of the cloth, in numbers that are known and in words from the limits on.

#include <nuno/feasibility.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scripted_engine.h"

namespace nuno {
namespace {

constexpr double pi = std::numbers::pi;

/// Something is said from beyond a limit on, and at it not yet.
void expect_limit(double Feasibility::*number, double limit, const std::string& words,
                  bool is_sheet = false) {
  Feasibility feasibility;
  feasibility.is_sheet = is_sheet;
  feasibility.*number = limit * (1 - 1e-9);
  EXPECT_EQ(verdict(feasibility), "");
  feasibility.*number = limit * (1 + 1e-9);
  EXPECT_NE(verdict(feasibility).find(words), std::string::npos) << verdict(feasibility);
}

TEST(Verdict, SpeaksBeyondItsLimitsAlone) {
  expect_limit(&Feasibility::length_mismatch, 0.01,
               "The target's segments differ from the cloth's by up to 1.0 %");
  expect_limit(&Feasibility::launch_strain, 0.02, "The launch stretches the cloth by some 2 %");
  expect_limit(&Feasibility::turning, 2 * pi, "turns 1.0 times against the rest");
  expect_limit(&Feasibility::folding, pi / 2, "folds by 90° at an edge", true);
  Feasibility feasibility;
  feasibility.steps = 100'000;
  EXPECT_EQ(verdict(feasibility), "");
  feasibility.steps = 100'001;
  EXPECT_EQ(verdict(feasibility),
            "The hinges are so stiff for segments so short that a flight takes 100001 steps.");
}

TEST(Verdict, OfASheetSaysOfEdgesWhatIsBeyondTheLimit) {
  Feasibility feasibility;
  feasibility.is_sheet = true;
  feasibility.length_mismatch = 0.05;
  feasibility.inside.too_short = 0.05;
  feasibility.border.too_long = 0.0099;
  EXPECT_EQ(verdict(feasibility),
            "The target is 5.0 % too short inside: the cloth comes near, not onto it.");
  feasibility.border.too_long = 0.0101;
  EXPECT_EQ(verdict(feasibility),
            "The target is 1.0 % too long along its border and 5.0 % too short inside: the cloth "
            "comes near, not onto it.");
}

TEST(Verdict, HasALineForEveryObstacle) {
  Feasibility feasibility;
  feasibility.length_mismatch = 0.5;
  feasibility.launch_strain = 0.5;
  feasibility.turning = 7;
  feasibility.steps = 200'000;
  const std::string words = verdict(feasibility);
  EXPECT_EQ(std::ranges::count(words, '\n'), 3);
}

Feasibility assessed(const Problem& problem) {
  return assess(ScriptedBackend(problem, 4, [](const Moment& now) { return now.positions; }));
}

TEST(Assessment, KnowsHowFarSegmentsDiffer) {
  Problem problem = problem_of(Points{{0, 1, 2, 3}, {0, 0, 0, 0}});
  problem.target = Points{{0, 1.25, 2.25, 3.25}, {0, 0, 0, 0}};
  EXPECT_DOUBLE_EQ(assessed(problem).length_mismatch, 0.25);
  problem.target = Points{{0, 1.25, 1.75, 2.75}, {0, 0, 0, 0}};
  EXPECT_DOUBLE_EQ(assessed(problem).length_mismatch, 0.5);
}

// Without drag and gravity a particle that flies alone has the velocity of its way in 1 s.
TEST(Assessment, KnowsHowTheLaunchStretches) {
  Problem problem = problem_of(Points{{0, 0.5, 1}, {0, 0, 0}});
  problem.target = Points{{0, 0.25, 1}, {0, 0, 3}};
  const Feasibility result = assessed(problem);
  // The first segment shortens by 0.25 m/s, the second lengthens so: half its length a second.
  EXPECT_DOUBLE_EQ(result.launch_stretching, 0.5);
  EXPECT_DOUBLE_EQ(result.launch_speed, 3);
  // c = √(EA·L/M) with EA = 200 N, L = 1 m and M = 0.1 kg.
  EXPECT_DOUBLE_EQ(result.launch_strain, 0.5 / std::sqrt(2000));
  EXPECT_EQ(result.steps, 4);
  EXPECT_EQ(result.time_step, 0.25);
}

TEST(Assessment, CountsTurnsAgainstTheMean) {
  // Segments that end at 0, 1 … 4 times a turn to one side: the mean turns by twice that.
  for (const double turn : {0.3, 2.5}) {
    Points initial(2, 6), target(2, 6);
    target.col(0).setZero();
    for (Index i = 0; i < 6; ++i) initial.col(i) << static_cast<double>(i), 0;
    for (Index i = 0; i < 5; ++i) {
      const double angle = turn * static_cast<double>(i);
      target.col(i + 1) = target.col(i) + Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    Problem problem = problem_of(initial);
    problem.target = target;
    EXPECT_NEAR(assessed(problem).turning, 2 * turn, 1e-12);
  }
}

}  // namespace
}  // namespace nuno
