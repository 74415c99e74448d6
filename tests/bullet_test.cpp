// The laws of a sheet in Bullet's world, and what it is never asked for.

#include <nuno/bullet.h>
#include <nuno/launch.h>
#include <nuno/rollout.h>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "sheets.h"

namespace nuno {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Two uneven triangles on an edge along x, the second turned up by `angle` against the first.
Mesh hinged(double angle) {
  Mesh mesh;
  mesh.vertices = Points{{0.0, 0.5, 0.2, 0.35},
                         {0.0, 0.0, 0.0, -0.4 * std::sin(angle)},
                         {0.0, 0.0, -0.3, 0.4 * std::cos(angle)}};
  mesh.faces = {{0, 1, 2}, {1, 0, 3}};
  return mesh;
}

/// The same particles with the springs taken out.
Problem lone_hinge(double angle, const SheetMaterial& material, Rest rest) {
  Problem problem = problem_of(hinged(angle), material, 0, rest);
  problem.sheet().stretch.stiffness.setZero();
  problem.sheet().stretch.damping.setZero();
  return problem;
}

/// Accelerations that a sheet has in its first step, which is half a kick.
Points first_acceleration(const Problem& problem, const Points& velocities) {
  const auto backend = bullet::make_backend(with_time_step(problem, 1e-3));
  const auto sheet = backend->start(velocities);
  sheet->step(Points::Zero(3, velocities.cols()));
  return (sheet->velocities() - velocities) / (backend->time_step() / 2);
}

Points forces(const Problem& problem, const Points& acceleration) {
  const Sheet& sheet = problem.sheet();
  return sheet.particle_mass * acceleration * sheet.relative_mass.asDiagonal();
}

/// A triangle of equal masses, of whose springs only the first is left.
Problem lone_spring(double stiffness, double damping) {
  Mesh mesh;
  mesh.vertices = Points{{-0.5, 0.5, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, std::sqrt(0.75)}};
  mesh.faces = {{0, 1, 2}};
  Problem problem = problem_of(mesh);
  Springs& springs = problem.sheet().stretch;
  springs.stiffness.setZero();
  springs.damping.setZero();
  springs.stiffness[0] = stiffness;
  springs.damping[0] = damping;
  return problem;
}

TEST(BulletSheet, ALoneSpringFollowsTheLeapfrog) {
  for (const double damping : {0.0, 0.004}) {
    const Problem problem = lone_spring(10, damping);
    const auto backend = bullet::make_backend(with_time_step(problem, 1e-3));
    Points stretched = problem.cloth().initial;
    stretched.row(0) *= 1.1;
    const auto sheet = backend->start(stretched, Points::Zero(3, 3));
    const double reduced = problem.cloth().particle_mass / 2;
    const double h = backend->time_step();
    double stretch = 0.1, rate = 0;
    for (Index n = 0; n < backend->steps(); ++n) {
      sheet->step(Points::Zero(3, 3));
      rate -= (n == 0 ? h / 2 : h) / reduced * (10 * stretch + damping * rate);
      stretch += h * rate;
      const double length = sheet->positions()(0, 1) - sheet->positions()(0, 0);
      // Rounding of coordinates of 1/2, 3e-8, that a thousand steps gather.
      ASSERT_NEAR(length, 1 + stretch, 5e-6) << "step " << n;
    }
    EXPECT_LT((sheet->positions().col(2) - problem.cloth().initial.col(2)).norm(), 5e-6);
  }
}

TEST(BulletSheet, ALoneHingeHasItsMomentAtAnyAngle) {
  const SheetMaterial material = {.air_drag = 0, .bending_stiffness = 1e-3};
  for (const double angle : {-3.1, -2.0, -0.5, -0.01, 0.0, 0.01, 0.3, 1.0, 1.7, 2.5, 3.1}) {
    const Problem problem = lone_hinge(angle, material, Rest::flat);
    const Points& x = problem.cloth().initial;
    const double theta = dihedral_angle(x, problem.sheet().hinges.corners.col(0));
    ASSERT_NEAR(std::abs(theta), std::abs(angle), 1e-12);
    const double moment = problem.sheet().hinges.stiffness[0] * theta;
    const Points f = forces(problem, first_acceleration(problem, Points::Zero(3, 4)));
    // Single precision of a force, of its heights and of an angle that is measured to 2e-7 rad.
    const double rounding = 2e-6 * (std::abs(moment) + problem.sheet().hinges.stiffness[0] * 0.2);
    // Each wing is turned about the edge by the same moment, one against the other.
    const Vector3d along = Vector3d::UnitX();
    for (const Index wing : {2, 3}) {
      const Vector3d arm = x.col(wing) - along * x(0, wing);
      const double turning = arm.cross(f.col(wing).head<3>()).dot(along);
      EXPECT_NEAR(std::abs(turning), std::abs(moment), rounding) << angle;
      EXPECT_LT(std::abs(f.col(wing).dot(arm)), rounding) << angle;
    }
    // It is the energy's derivative: closing the angle by a small turn of the second wing.
    const double turn = 1e-4;
    Points opened = x;
    opened.col(3) = Eigen::AngleAxisd(turn, along) * x.col(3).head<3>();
    const double change = dihedral_angle(opened, problem.sheet().hinges.corners.col(0)) - theta;
    const Vector3d arm = x.col(3) - along * x(0, 3);
    EXPECT_NEAR(arm.cross(f.col(3).head<3>()).dot(along), -moment * change / turn, rounding);
    // Nothing else moves: no sum of forces, no sum of moments.
    Vector3d torque = Vector3d::Zero();
    for (Index i = 0; i < 4; ++i) torque += x.col(i).head<3>().cross(f.col(i).head<3>());
    EXPECT_LT(f.rowwise().sum().norm(), 10 * rounding) << angle;
    EXPECT_LT(torque.norm(), 10 * rounding) << angle;
  }
}

TEST(BulletSheet, AHingeRestsAtTheAngleOfItsStart) {
  const SheetMaterial material = {.air_drag = 0, .bending_stiffness = 1e-3};
  const Problem problem = lone_hinge(1.2, material, Rest::initial);
  const Points f = forces(problem, first_acceleration(problem, Points::Zero(3, 4)));
  EXPECT_LT(f.norm(), 1e-6 * problem.sheet().hinges.stiffness[0]);
}

TEST(BulletSheet, AFoldIsPulledBackTheShortWayRound) {
  const SheetMaterial material = {.air_drag = 0, .bending_stiffness = 1e-3};
  const double turn = 0.3;  // through π, where the angle's sign changes
  Problem problem = lone_hinge(pi - 0.1, material, Rest::initial);
  const Points from = problem.cloth().initial, to = hinged(pi - 0.1 + turn).vertices;
  const double k = problem.sheet().hinges.stiffness[0];
  problem.sheet().initial = to;
  const Points f = forces(problem, first_acceleration(problem, Points::Zero(3, 4)));
  const Vector3d arm = to.col(3) - Vector3d::UnitX() * to(0, 3);
  const double back = arm.cross((from.col(3) - to.col(3)).head<3>()).dot(Vector3d::UnitX());
  const double moment = arm.cross(f.col(3).head<3>()).dot(Vector3d::UnitX());
  EXPECT_NEAR(moment, std::copysign(k * turn, back), 2e-6 * k);
}

TEST(BulletSheet, AHingesDashpotBrakesItsTurning) {
  const SheetMaterial material = {.air_drag = 0, .bending_stiffness = 0, .bending_damping = 1e-4};
  const Problem problem = lone_hinge(0.7, material, Rest::flat);
  const Points& x = problem.cloth().initial;
  Points velocities = Points::Zero(3, 4);
  const double rate = 2;  // rad/s of the second wing about the edge
  const Vector3d arm = x.col(3) - Vector3d::UnitX() * x(0, 3);
  velocities.col(3) = rate * Vector3d::UnitX().cross(arm);
  const Points f = forces(problem, first_acceleration(problem, velocities));
  const double moment = problem.sheet().hinges.damping[0] * rate;
  EXPECT_NEAR(arm.cross(f.col(3).head<3>()).dot(Vector3d::UnitX()), -moment, 2e-4 * moment);
}

TEST(BulletSheet, DragAndGravityAreExactAtAnyStep) {
  Problem problem = problem_of(grid(3, 3, 0.5));
  for (const double drag_rate : {0.0, 1e-9, 1e-4, 0.3, 5.0, 200.0}) {
    problem.sheet().drag_rate = drag_rate;
    problem.sheet().gravity = 9.8;
    problem.target.colwise() += Vector3d(3, 1, -2);
    for (const double step : {1e-1, 1e-3}) {
      const auto backend = bullet::make_backend(with_time_step(problem, step));
      const Points engines = ballistic_launch(problem.cloth().initial, problem.target, 9.8,
                                              backend->drag_recurrence(), backend->steps());
      const Points paper =
          ballistic_launch(problem.cloth().initial, problem.target, 1, 9.8, drag_rate);
      EXPECT_LT((engines - paper).norm(), 1e-11 * paper.norm()) << drag_rate;
    }
  }
}

TEST(BulletSheet, FliesTheSameFarFromTheOrigin) {
  SheetScene scene;
  const Mesh mesh = grid(7, 6, 0.15);
  scene.initial = mesh.vertices;
  scene.faces = mesh.faces;
  scene.target = rolled(mesh.vertices, 2);
  scene.arrival_time = 1;
  SheetScene far = scene;
  const Vector3d away(1e5, -2e5, 3e5);
  far.initial.colwise() += away;
  far.target.colwise() += away;
  const Problem near_problem = make_problem(scene), far_problem = make_problem(far);
  const double gain = 3 * near_problem.cloth().particle_mass;
  const Points near_end = rollout(*bullet::make_backend(near_problem), gain).final;
  const Rollout far_flight = rollout(*bullet::make_backend(far_problem), gain);
  // A coordinate of 3e5 m has 6e-11 m in double precision; in single it would have 3e-2 m.
  EXPECT_LT(((far_flight.final.colwise() - away) - near_end).colwise().norm().maxCoeff(), 1e-5);
  EXPECT_LT(far_flight.error.centroid, 1e-8);
}

TEST(BulletSheet, ATotalForceMovesTheMassCentreAlone) {
  const Problem problem = problem_of(grid(4, 3, 0.3));
  const auto backend = bullet::make_backend(problem);
  const Sheet& cloth = problem.sheet();
  const auto sheet = backend->start(Points::Zero(3, 12));
  const Vector3d acceleration(1, -2, 3);
  const Points push = cloth.particle_mass * acceleration * cloth.relative_mass.transpose();
  for (Index n = 0; n < backend->steps(); ++n) sheet->step(push);
  const Points moved = sheet->positions() - cloth.initial;
  // ½·a·t², which this recurrence has exactly.
  EXPECT_LT((moved.colwise() - 0.5 * acceleration).colwise().norm().maxCoeff(), 1e-6);
}

TEST(BulletSheet, BringsTheMassCentreHomeAtAnyGain) {
  SheetScene scene;
  const Mesh mesh = grid(6, 6, 0.2, Tiles::triangles);
  scene.initial = mesh.vertices;
  scene.faces = mesh.faces;
  scene.target = rolled(mesh.vertices, 3).colwise() + Vector3d(3, 1, 1);
  scene.arrival_time = 1;
  const auto backend = bullet::make_backend(make_problem(scene));
  const Cloth& cloth = backend->cloth();
  for (const double times : {0.0, 1.0, 30.0, 1e3, 1e4}) {
    const Rollout flight = rollout(*backend, times * cloth.particle_mass);
    ASSERT_EQ(flight.status, RolloutStatus::ok) << times;
    const Vector off =
        cloth.mass_center(flight.final) - cloth.mass_center(backend->problem().target);
    EXPECT_LT(off.norm(), 1e-9 * cloth.size) << times;
  }
}

// ---- what Bullet is never asked for ----------------------------------------------------------

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
