// What Bullet is never asked for, and what a sheet that leaves its range becomes.

#include <nuno/bullet.h>
#include <nuno/launch.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hinged.h"
#include "sheets.h"

namespace nuno {
namespace {

using Eigen::Vector3d;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(BulletLimits, ABadForceEndsTheFlightForGood) {
  const auto backend = bullet::make_backend(problem_of(hinged(1)));
  for (const double bad : {nan, infinity, -infinity, 1e300, 1e38, 1e25}) {
    for (Index place = 0; place < 12; ++place) {
      const auto sheet = backend->start(Points::Zero(3, 4));
      sheet->step(Points::Zero(3, 4));
      EXPECT_EQ(sheet->failure(), "");
      Points push = Points::Zero(3, 4);
      push(place) = bad;
      sheet->step(push);
      EXPECT_TRUE(sheet->positions().array().isNaN().all()) << bad;
      EXPECT_FALSE(sheet->failure().empty());
      sheet->step(Points::Zero(3, 4));  // nothing wakes it
      EXPECT_TRUE(sheet->positions().array().isNaN().all()) << bad;
      EXPECT_TRUE(sheet->velocities().array().isNaN().all()) << bad;
    }
  }
}

TEST(BulletLimits, ABadLaunchNeverReachesBullet) {
  const auto backend = bullet::make_backend(problem_of(hinged(1)));
  for (const double bad : {nan, infinity, -infinity, 1e300, 1e38, 1e6}) {
    Points velocities = Points::Zero(3, 4);
    velocities(1, 1) = bad;
    const auto launched = backend->start(velocities);
    launched->step(Points::Zero(3, 4));
    EXPECT_TRUE(launched->positions().array().isNaN().all()) << bad;
    EXPECT_TRUE(launched->failure().starts_with("a particle is launched faster than")) << bad;

    Points positions = backend->cloth().initial;
    positions(2, 3) = bad;
    const auto placed = backend->start(positions, Points::Zero(3, 4));
    placed->step(Points::Zero(3, 4));
    EXPECT_TRUE(placed->positions().array().isNaN().all()) << bad;
    EXPECT_FALSE(placed->failure().empty()) << bad;
  }
}

TEST(BulletLimits, AMotionOfMoreThanTheSheetsSizePerStepHasDiverged) {
  const auto backend = bullet::make_backend(with_time_step(problem_of(grid(3, 3, 0.5)), 1e-3));
  const double per_step = backend->cloth().size / backend->time_step();
  const Points none = Points::Zero(3, 9);
  Points outwards = Points::Zero(3, 9);
  outwards(1, 0) = per_step, outwards(1, 8) = -per_step;  // the mass centre stays
  const auto allowed = backend->start(0.9 * outwards);
  const auto refused = backend->start(1.1 * outwards);
  EXPECT_EQ(allowed->failure(), "");
  EXPECT_TRUE(refused->failure().starts_with("a particle is launched faster than"));
  // Together they may be as fast as they like: Bullet does not see the mass centre's motion.
  const auto together = backend->start(Vector3d(0, 1e3 * per_step, 0).replicate(1, 9));
  together->step(none);
  EXPECT_TRUE(together->positions().allFinite());
  // Pushed over the limit later: the step that would pass it is the last.
  const auto pushed = backend->start(Points::Zero(3, 9));
  pushed->step(none);
  Points push = Points::Zero(3, 9);
  push(1, 0) = 2 * backend->cloth().particle_mass * per_step / backend->time_step();
  push(1, 8) = -push(1, 0);
  pushed->step(push);
  EXPECT_TRUE(pushed->positions().array().isNaN().all());
  EXPECT_TRUE(pushed->failure().starts_with("a particle gets faster than"));
}

TEST(BulletLimits, ATotalForceMayBeAsLargeAsItLikes) {
  const auto backend = bullet::make_backend(with_time_step(problem_of(grid(3, 3, 0.5)), 1e-3));
  const Cloth& cloth = backend->cloth();
  const double per_step = cloth.size / backend->time_step();
  const Vector3d acceleration(0, 10 * per_step / backend->time_step(), 0);
  const auto sheet = backend->start(Points::Zero(3, 9));
  sheet->step(cloth.particle_mass * acceleration * cloth.relative_mass.transpose());
  ASSERT_EQ(sheet->failure(), "");
  EXPECT_NEAR(cloth.mass_center(sheet->velocities()).y(), 5 * per_step, 1e-9 * per_step);
}

TEST(BulletLimits, ACrumpledSheetOpensAsFastAsItIsLaunched) {
  // Bullet moves no node by more than the diagonal of the body's box, which here is small.
  const auto backend = bullet::make_backend(with_time_step(problem_of(grid(3, 3, 0.5)), 1e-5));
  const Points small = 1e-3 * backend->cloth().initial;
  const Points opening =
      0.5 * backend->cloth().size / backend->time_step() * backend->cloth().initial;
  const auto sheet = backend->start(small, opening);
  sheet->step(Points::Zero(3, 9));
  const Points expected = small + backend->time_step() * opening;
  // Springs turn the velocity by h²·k/m, 1e-6, of their length.
  EXPECT_LT((sheet->positions() - expected).norm(), 1e-4);
}

TEST(BulletLimits, ASheetThatHasCollapsedFliesOnOrGivesUpInWords) {
  const Mesh mesh = grid(3, 3, 0.5);
  const auto backend = bullet::make_backend(problem_of(mesh, {.bending_stiffness = 1e-3}));
  Points line = mesh.vertices, point = mesh.vertices, folded = mesh.vertices;
  line.row(2).setZero();
  point.setZero();
  for (Index i = 0; i < 9; ++i) folded(0, i) = std::abs(folded(0, i));
  for (const Points& positions : {line, point, folded}) {
    const auto sheet = backend->start(positions, Points::Zero(3, 9));
    for (int n = 0; n < 100; ++n) sheet->step(Points::Zero(3, 9));
    EXPECT_TRUE(sheet->positions().allFinite() ||
                (sheet->positions().array().isNaN().all() && !sheet->failure().empty()));
  }
}

TEST(BulletLimits, ExtremeScenesAreRefusedOrFlyOrDivergeButNeverAbort) {
  SheetScene plain;
  const Mesh mesh = hinged(0.4);
  plain.arrival_time = 1;
  plain.initial = mesh.vertices;
  plain.faces = mesh.faces;
  plain.target = mesh.vertices.colwise() + Vector3d(3, 1, 0);
  const std::vector<void (*)(SheetScene&, double)> changes = {
      [](SheetScene& s, double x) { s.arrival_time = x; },
      [](SheetScene& s, double x) { s.gravity = x; },
      [](SheetScene& s, double x) { s.cloth.areal_density = x; },
      [](SheetScene& s, double x) { s.cloth.air_drag = x; },
      [](SheetScene& s, double x) { s.cloth.stretch_stiffness = x; },
      [](SheetScene& s, double x) { s.cloth.stretch_damping = x; },
      [](SheetScene& s, double x) { s.cloth.bending_stiffness = x; },
      [](SheetScene& s, double x) { s.cloth.bending_damping = x; },
      [](SheetScene& s, double x) { s.initial *= x; },
      [](SheetScene& s, double x) { s.initial.row(2) *= x; },
      [](SheetScene& s, double x) { s.initial(2, 3) = x; },
      [](SheetScene& s, double x) { s.target *= x; },
      [](SheetScene& s, double x) { s.initial *= x, s.target *= x; },
  };
  for (const auto& change : changes) {
    for (const double value :
         {1e-300, 1e-160, 1e-30, 1e-12, 1e-8, 1e-4, 1e4, 1e8, 1e12, 1e30, 1e160, 1e300}) {
      for (const TargetLength length : {TargetLength::fit, TargetLength::as_drawn}) {
        SheetScene scene = plain;
        scene.target_length = length;
        change(scene, value);
        try {
          const auto backend = bullet::make_backend(make_problem(scene));
          EXPECT_GT(backend->steps(), 0);
          const auto sheet = backend->start(launch(*backend));
          for (int n = 0; n < 20; ++n) {
            sheet->step(Points::Constant(3, 4, backend->cloth().particle_mass));
          }
          EXPECT_TRUE(sheet->positions().allFinite() ||
                      (sheet->positions().array().isNaN().all() && !sheet->failure().empty()));
        } catch (const InputError& error) {
          EXPECT_EQ(std::string(error.what()).find("nan"), std::string::npos) << error.what();
        }
      }
    }
  }
}

TEST(BulletLimits, AWishForTooManyStepsIsRefusedByName) {
  const auto complaint = [](double wish) -> std::string {
    try {
      bullet::make_backend(with_time_step(problem_of(hinged(1)), wish));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(1e-9),
            "/time_step: 1e-09 takes 1e+09 steps on bullet, which is not <= 50000000");
  EXPECT_EQ(complaint(0), "/time_step: 0 is not > 0");
  EXPECT_EQ(complaint(nan), "/time_step: nan is not > 0");
  EXPECT_EQ(complaint(1e-7), "");
}

TEST(BulletLimits, WhatMakesTooManyStepsIsNamed) {
  const auto complaint = [](const SheetMaterial& material) -> std::string {
    try {
      bullet::make_backend(problem_of(grid(3, 3, 0.5), material));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_TRUE(
      complaint({.stretch_stiffness = 1e20}).starts_with("/cloth/stretch_stiffness: 1e+20"));
  EXPECT_TRUE(complaint({.stretch_damping = 1e20}).starts_with("/cloth/stretch_damping: 1e+20"));
  EXPECT_TRUE(complaint({.shear_stiffness = 1e20}).starts_with("/cloth/shear_stiffness: 1e+20"));
  EXPECT_TRUE(complaint({.shear_damping = 1e20}).starts_with("/cloth/shear_damping: 1e+20"));
  EXPECT_TRUE(
      complaint({.bending_stiffness = 1e20}).starts_with("/cloth/bending_stiffness: 1e+20"));
  EXPECT_TRUE(complaint({.bending_damping = 1e20}).starts_with("/cloth/bending_damping: 1e+20"));
}

TEST(BulletLimits, AWishForTooLongAStepIsCutToWhatIsStable) {
  // Each part of the material in turn decides, thrown hard and with the shape of a crushed sheet.
  for (const SheetMaterial& material :
       {SheetMaterial{}, SheetMaterial{.stretch_damping = 1}, SheetMaterial{.shear_stiffness = 5e4},
        SheetMaterial{.shear_damping = 1}, SheetMaterial{.bending_stiffness = 1},
        SheetMaterial{.bending_damping = 1e-2}}) {
    const Mesh mesh = grid(5, 5, 0.25);
    const auto backend = bullet::make_backend(with_time_step(problem_of(mesh, material, 9.8), 1));
    // Crumpled by a hundredth of a spacing in every direction, which excites all modes.
    Points crumpled = mesh.vertices;
    for (Index i = 0; i < crumpled.size(); ++i) {
      crumpled(i) += 0.0025 * std::sin(static_cast<double>(7 * i * i));
    }
    const auto sheet = backend->start(crumpled, Points::Zero(3, 25));
    double fastest = 0;
    for (Index n = 0; n < backend->steps(); ++n) {
      sheet->step(Points::Zero(3, 25));
      ASSERT_TRUE(sheet->positions().allFinite());
      fastest = backend->cloth().shape_of(sheet->velocities()).colwise().norm().maxCoeff();
    }
    // It began with strains of a few percent at rest; an unstable mode would be past all bounds.
    EXPECT_LT(fastest, 0.05 * backend->cloth().sound_speed * 10);
  }
}

TEST(BulletLimits, AChainIsRefusedInOneLineThatSaysWhoFliesIt) {
  ChainScene chain;
  chain.arrival_time = 1;
  chain.initial = Points{{0.0, 1.0}, {0.0, 0.0}};
  chain.target = chain.initial;
  try {
    bullet::make_backend(make_problem(chain));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "bullet flies sheets; a chain flies on native and on box2d");
  }
}

}  // namespace
}  // namespace nuno
