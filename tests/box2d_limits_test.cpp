// No input may end in one of Box2D's assertions.

#include <nuno/box2d.h>
#include <nuno/launch.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include "bare_problem.h"

#include <cmath>
#include <limits>

namespace nuno {
namespace {

using box2d::Hinge;
using Eigen::Vector2d;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Box2dLimits, ABadForceEndsTheFlightForGood) {
  const auto backend = box2d::make_backend(problem_of(bent(1)));
  for (const double bad : {nan, infinity, -infinity, 1e300, 1e38, 1e30}) {
    for (Index place = 0; place < 6; ++place) {
      const auto chain = backend->start(backend->problem().chain().initial, Points::Zero(2, 3));
      chain->step(Points::Zero(2, 3));
      Points forces = Points::Zero(2, 3);
      forces(place) = bad;
      chain->step(forces);
      EXPECT_TRUE(chain->positions().array().isNaN().all()) << bad;
      EXPECT_EQ(chain->failure(), "a force is larger than Box2D can take in one step");
      chain->step(Points::Zero(2, 3));  // nothing wakes it
      EXPECT_TRUE(chain->positions().array().isNaN().all()) << bad;
    }
  }
}

TEST(Box2dLimits, ABadLaunchNeverReachesBox2d) {
  const auto backend = box2d::make_backend(problem_of(bent(1)));
  for (const double bad : {nan, infinity, -infinity, 1e300, 1e38, 1e6}) {
    Points launch = Points::Zero(2, 3);
    launch(1, 1) = bad;
    const auto chain = backend->start(backend->problem().chain().initial, launch);
    chain->step(Points::Zero(2, 3));
    EXPECT_TRUE(chain->positions().array().isNaN().all()) << bad;
    EXPECT_TRUE(chain->failure().starts_with("a rod is launched faster than Box2D moves it"));
  }
}

TEST(Box2dLimits, AMotionThatBox2dWouldClampHasDiverged) {
  const auto backend = box2d::make_backend(with_time_step(problem_of(bent(1)), 1e-3));
  const double h = backend->time_step();
  const Points& initial = backend->cloth().initial;
  const Points arm = shape_of(initial);
  Points turning(2, 3);  // by a radian per second
  turning << -arm.row(1), arm.row(0);
  const auto turned = [&](double per_step) {
    return backend->start(initial, per_step / h * turning);
  };
  const Points none = Points::Zero(2, 3);
  const auto allowed = turned(1.45), clamped = turned(1.55);
  allowed->step(none);
  clamped->step(none);
  EXPECT_TRUE(allowed->positions().allFinite());
  EXPECT_TRUE(clamped->positions().array().isNaN().all());
  // Pushed over the limit on the way: the step that passes it is the last.
  const auto pushed = turned(0);
  const Points forces = backend->cloth().particle_mass * turning / (h * h);
  pushed->step(forces);  // half a kick
  EXPECT_EQ(pushed->failure(), "");
  pushed->step(2 * forces);
  EXPECT_TRUE(pushed->positions().array().isNaN().all());
  EXPECT_TRUE(pushed->failure().starts_with("a rod gets faster than Box2D moves it"));
  // How fast it flies as a whole does not matter.
  const auto thrown = backend->start(initial, Vector2d(1e5, 1e5).replicate(1, 3));
  thrown->step(none);
  EXPECT_TRUE(thrown->positions().allFinite());
}

TEST(Box2dLimits, ExtremeScenesAreRefusedOrFlyOrDivergeButNeverAbort) {
  ChainScene plain;
  plain.arrival_time = 1;
  plain.particles = 5;
  plain.initial = Points{{0.0, 1.0, 1.5}, {0.0, 0.0, 0.5}};
  plain.target = Points{{3.0, 3.5}, {1.0, 2.0}};
  const std::vector<void (*)(ChainScene&, double)> changes = {
      [](ChainScene& s, double x) { s.arrival_time = x; },
      [](ChainScene& s, double x) { s.gravity = x; },
      [](ChainScene& s, double x) { s.cloth.mass = x; },
      [](ChainScene& s, double x) { s.cloth.air_drag = x; },
      [](ChainScene& s, double x) { s.cloth.hinge_stiffness = x; },
      [](ChainScene& s, double x) { s.cloth.hinge_damping = x; },
      [](ChainScene& s, double x) { s.initial *= x; },
      [](ChainScene& s, double x) { s.target *= x; },
      [](ChainScene& s, double x) { s.initial *= x, s.target *= x; },
  };
  for (const auto& change : changes) {
    for (const double value : {1e-300, 1e-160, 1e-80, 1e-30, 1e-8, 1e8, 1e30, 1e80, 1e160, 1e300}) {
      for (const Hinge form : {Hinge::soft_weld, Hinge::spring_pair}) {
        ChainScene scene = plain;
        change(scene, value);
        try {
          const Problem problem = make_problem(scene);
          const auto backend = box2d::make_backend_with({.hinge = form}, problem);
          EXPECT_GT(backend->steps(), 0);
          const auto chain = backend->start(
              backend->problem().chain().initial,
              ballistic_launch(problem.chain().initial, problem.target, problem.arrival_time,
                               problem.chain().gravity, problem.chain().drag_rate));
          for (int n = 0; n < 20; ++n) {
            chain->step(Points::Constant(2, 5, problem.chain().particle_mass));
          }
          EXPECT_TRUE(chain->positions().allFinite() || chain->positions().array().isNaN().all());
        } catch (const InputError& error) {
          EXPECT_EQ(std::string(error.what()).find("nan"), std::string::npos) << error.what();
        }
      }
    }
  }
}

TEST(Box2dLimits, AWishForTooManyStepsIsRefusedByName) {
  const auto complaint = [](double wish) -> std::string {
    try {
      box2d::make_backend(with_time_step(problem_of(bent(1)), wish));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(1e-9),
            "/time_step: 1e-09 takes 1e+09 steps on box2d, which is not <= 50000000");
  EXPECT_EQ(complaint(0), "/time_step: 0 is not > 0");
  EXPECT_EQ(complaint(nan), "/time_step: nan is not > 0");
  EXPECT_EQ(complaint(1e-7), "");

  try {
    const ChainMaterial rigid{.air_drag = 0, .hinge_damping = 1234567};
    box2d::make_backend_with({.hinge = box2d::Hinge::spring_pair}, problem_of(bent(1), 0, rigid));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("/cloth/hinge_damping: 1234567 takes "))
        << error.what();
  }
}

TEST(Box2dLimits, AWishForTooLongAStepIsCutToWhatTheClothNeeds) {
  const ChainMaterial stiff{.air_drag = 0, .hinge_stiffness = 1};
  const auto sprung = box2d::make_backend(with_time_step(problem_of(bent(0.1), 0, stiff), 1));
  const double per_hinge = 16 / (0.4 * 0.3 * 0.3 * sprung->problem().chain().particle_mass);
  EXPECT_LE(per_hinge * std::pow(sprung->time_step(), 2) * stiff.hinge_stiffness, 600);
  EXPECT_EQ(rollout(*sprung, 0).status, RolloutStatus::ok);

  // Dashpots ask for nothing but of the pair, whose springs are explicit.
  const ChainMaterial damped{.air_drag = 0, .hinge_stiffness = 0, .hinge_damping = 1};
  const Problem braked = with_time_step(problem_of(bent(0.1), 0, damped), 1);
  EXPECT_EQ(box2d::make_backend(braked)->steps(), 1);
  const auto pair = box2d::make_backend_with({.hinge = box2d::Hinge::spring_pair}, braked);
  EXPECT_LE(per_hinge * pair->time_step() * damped.hinge_damping, 0.5);

  const auto dragged = box2d::make_backend(
      with_time_step(problem_of(bent(1), 9.8, {.air_drag = 10, .hinge_stiffness = 0}), 1));
  EXPECT_LE(dragged->time_step() * 100, 0.25);
  Problem spread = problem_of(bent(1));
  spread.target *= 1000;
  const auto fast = box2d::make_backend(with_time_step(spread, 1));
  EXPECT_LE(fast->time_step() * 999 * shape_of(bent(1)).colwise().norm().maxCoeff(), 0.4);
  // Neither gravity nor distance asks for anything.
  Problem far = problem_of(bent(1), 1000);
  far.target.array() += 1e6;
  EXPECT_EQ(box2d::make_backend(with_time_step(far, 1e-2))->steps(), 100);
}

TEST(Box2dLimits, AChainTooLongOrTooUnevenForSinglePrecisionIsRefused) {
  Points line(2, 5000);
  for (Index i = 0; i < 5000; ++i) line.col(i) = Vector2d(static_cast<double>(i), 0);
  EXPECT_THROW(box2d::make_backend(problem_of(line)), InputError);
  EXPECT_THROW(box2d::make_backend(problem_of(bent(1, 1, 1e-4))), InputError);
  EXPECT_NO_THROW(box2d::make_backend(problem_of(bent(1, 1, 2e-3))));
}

}  // namespace
}  // namespace nuno
