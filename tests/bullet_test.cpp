// The laws of a sheet in Bullet's world.

#include <nuno/bullet.h>
#include <nuno/launch.h>
#include <nuno/rollout.h>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hinged.h"
#include "sheets.h"

namespace nuno {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// Two hinged triangles with the springs taken out.
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

}  // namespace
}  // namespace nuno
