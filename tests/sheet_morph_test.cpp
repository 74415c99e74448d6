#include <nuno/reference_motion.h>
#include <nuno/sheet_morph.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <string>

#include "sheet_library.h"

namespace nuno {
namespace {

using Eigen::Vector3d;
using scene_library::bent;
using scene_library::FlatMesh;
using scene_library::grid;
using scene_library::in_triangles;
using scene_library::placed;
using std::numbers::pi;

Problem problem_of(const Points& initial, const Faces& faces, const Points& target,
                   Arrival arrival = Arrival::pass) {
  SheetScene scene;
  scene.arrival_time = 0.8;
  scene.initial = initial;
  scene.faces = faces;
  scene.target = target;
  scene.target_length = TargetLength::as_drawn;
  scene.reference = Reference::morph;
  scene.arrival = arrival;
  return make_problem(scene);
}

/// A steady curvature: the way turns by `turn` [rad] in a metre.
auto rolling(double turn) {
  return [turn](double u) { return turn * u; };
}

Points saddle(const Points& flat, double height) {
  Points x = flat;
  x.row(1) = height * (flat.row(0).array().square() - flat.row(2).array().square()).matrix();
  return x;
}

/// The shapes at s = 0, 1/steps … 1.
std::vector<Points> way(const Problem& problem, Index steps) {
  SheetMorph morph(problem, 1 / static_cast<double>(steps));
  std::vector<Points> shapes = {morph.shape()};
  for (Index n = 0; n < steps; ++n) {
    morph.advance();
    shapes.push_back(morph.shape());
  }
  return shapes;
}

double strain(const Cloth& cloth, const Points& x) {
  double largest = 0;
  for (Index e = 0; e < cloth.edges.cols(); ++e) {
    const double length = (x.col(cloth.edges(1, e)) - x.col(cloth.edges(0, e))).norm();
    largest = std::max(largest, std::abs(length / cloth.rest_length[e] - 1));
  }
  return largest;
}

double largest_difference(const std::vector<Points>& one, const std::vector<Points>& other) {
  double largest = 0;
  for (std::size_t k = 0; k < one.size(); ++k) {
    largest = std::max(largest, (one[k] - other[k]).colwise().norm().maxCoeff());
  }
  return largest;
}

struct Throw {
  const char* name;
  FlatMesh mesh;
  Points target;
};

std::vector<Throw> throws() {
  const FlatMesh quads = grid(1, 1, 13, 13), triangles = in_triangles(quads);
  const FlatMesh disc = scene_library::uneven_ring(0, 0.5, 0.08);
  const Vector3d turn(0.9, -0.4, 1.3), away(3, 1, 0.5);
  const auto s_curve = [](double u) { return 1.2 * std::cos(2 * pi * u); };
  const Points& x = quads.vertices;
  return {
      {"half pipe", quads, bent(x, 0, rolling(pi))},
      {"half pipe of triangles, turned", triangles, placed(bent(x, 0, rolling(pi)), turn, away)},
      {"S", quads, bent(x, 0, s_curve)},
      {"S, turned", triangles, placed(bent(x, 0, s_curve), turn, away)},
      {"disc rolled askew", disc, placed(bent(disc.vertices, 0.7, rolling(1.8 * pi)), turn, away)},
      {"saddle", quads, saddle(x, 0.5)},
      {"saddle, turned", triangles, placed(saddle(x, 0.5), turn, away)}};
}

TEST(SheetMorph, StretchesOnTheWayNoMoreThanTheTarget) {
  for (const auto& [name, mesh, target] : throws()) {
    const Problem problem = problem_of(mesh.vertices, mesh.faces, target);
    const double bound = strain(problem.cloth(), problem.target) + 5e-3;
    for (const Points& x : way(problem, 200)) EXPECT_LT(strain(problem.cloth(), x), bound) << name;
  }
}

TEST(SheetMorph, BeginsAndEndsExactly) {
  for (const auto& [name, mesh, target] : throws()) {
    for (const Arrival arrival : {Arrival::pass, Arrival::settle}) {
      const Problem problem = problem_of(mesh.vertices, mesh.faces, target, arrival);
      const Cloth& cloth = problem.cloth();
      const std::vector<Points> shapes = way(problem, 1000);
      // A rotation there and back again, of coordinates of order 1.
      EXPECT_LT((shapes.front() - cloth.shape_of(cloth.initial)).cwiseAbs().maxCoeff(), 4e-15);
      EXPECT_LT((shapes.back() - cloth.shape_of(problem.target)).cwiseAbs().maxCoeff(), 4e-15);
      for (const Points& x : shapes) EXPECT_LT(cloth.mass_center(x).norm(), 1e-14) << name;
    }
  }
}

TEST(SheetMorph, TakesARigidMotionAsASteadyRotation) {
  const FlatMesh disc = scene_library::uneven_ring(0.1, 0.5, 0.08);
  const Points start = bent(disc.vertices, 0.3, rolling(2));
  for (const double angle : {0.0, 1e-9, 1.0, 3.1}) {
    const Vector3d axis = Vector3d(1, 2, -2) / 3;
    const Problem problem = problem_of(start, disc.faces, placed(start, angle * axis, {3, 1, 0}));
    const Points shape = problem.cloth().shape_of(start);
    const std::vector<Points> shapes = way(problem, 50);
    for (std::size_t n = 0; n < shapes.size(); ++n) {
      const Points expected = placed(shape, static_cast<double>(n) / 50 * angle * axis, {0, 0, 0});
      // The Poisson solve of 100 vertices loses two digits.
      EXPECT_LT((shapes[n] - expected).cwiseAbs().maxCoeff(), 1e-13) << angle;
    }
  }
}

TEST(SheetMorph, TurnsTheWholeTheShorterWay) {
  const FlatMesh mesh = grid(1, 1, 3, 3);
  const double turn = 350.0 / 180 * pi;
  const Problem problem =
      problem_of(mesh.vertices, mesh.faces, placed(mesh.vertices, {0, turn, 0}, {3, 0, 0}));
  const SheetMorph morph(problem, 1e-3);
  const double rate = morph.velocity_at_start().col(0).norm() / std::sqrt(0.5);
  EXPECT_NEAR(rate * problem.arrival_time, 10.0 / 180 * pi, 1e-9);
}

// A strip that is rolled up turns at one end by many times π against the other, about lines askew
// to its edges, so that no triangle's own rotation tells how often.
TEST(SheetMorph, RollsUpAnyNumberOfTimes) {
  for (const bool cut : {false, true}) {
    const FlatMesh quads = grid(1, 0.08, 76, 7), mesh = cut ? in_triangles(quads) : quads;
    for (const double turns : {1.0, 2.0, 3.0}) {
      const Points target = bent(mesh.vertices, 0.2, rolling(2 * pi * turns));
      const Problem problem = problem_of(mesh.vertices, mesh.faces, target);
      const std::vector<Points> shapes = way(problem, 200);
      const double bound = strain(problem.cloth(), problem.target) + 5e-3;
      for (const Points& x : shapes) EXPECT_LT(strain(problem.cloth(), x), bound) << turns;
      // Half way it has rolled up by half as many turns: the same curvature all along.
      const Points half = problem.cloth().shape_of(bent(mesh.vertices, 0.2, rolling(pi * turns)));
      // Chords differ from arcs by the square of an edge's turn over 24.
      EXPECT_LT((shapes[100] - half).colwise().norm().maxCoeff(), 2e-3) << turns;
    }
  }
}

/// A strip of eight triangles in a zigzag, its inner edges folded by `share` of 1 rad and −0.8 rad.
Points folded(const Points& flat, double share) {
  Points x = flat;
  Eigen::Affine3d moved = Eigen::Affine3d::Identity();  // what comes after an edge goes with it
  for (Index i = 1; i + 2 < flat.cols(); ++i) {
    const Vector3d end = flat.col(i), edge = flat.col(i + 1) - flat.col(i);
    const double angle = share * (i % 3 == 0 ? -0.8 : 1);
    moved = moved * Eigen::Translation3d(end) *
            Eigen::AngleAxisd(angle, (i % 2 ? -1 : 1) * edge.normalized()) *
            Eigen::Translation3d(-end);
    x.col(i + 2) = moved * Vector3d(flat.col(i + 2));
  }
  return x;
}

// Folds about edges in different directions, one after another: neighbours turn against each other
// steadily only if every face turns about an axis that turns with it.
TEST(SheetMorph, FoldsEveryEdgeOfAStripSteadily) {
  Points flat(3, 10);
  Faces faces;
  for (Index i = 0; i < flat.cols(); ++i) {
    flat.col(i) << 0.25 * static_cast<double>(i), 0, i % 2 ? 0.45 : 0;
    if (i + 2 < flat.cols()) faces.push_back({i, i + 1, i + 2});
  }
  const Problem problem = problem_of(flat, faces, folded(flat, 1));
  const Hinges& hinges = problem.sheet().hinges;
  const std::vector<Points> shapes = way(problem, 64);
  for (std::size_t n = 0; n < shapes.size(); ++n) {
    const Points expected = folded(flat, static_cast<double>(n) / 64);
    for (Index h = 0; h < hinges.count(); ++h) {
      // 1e-4 rad is what steps of second order leave of a turn of 1/32 rad each; of first order, 20
      // times as much.
      EXPECT_NEAR(dihedral_angle(shapes[n], hinges.corners.col(h)),
                  dihedral_angle(expected, hinges.corners.col(h)), 3e-4)
          << n << " " << h;
    }
  }
}

TEST(SheetMorph, IsTheSameForRenumberedVertices) {
  for (const auto& [name, mesh, target] : throws()) {
    const Index n = target.cols();
    const auto moved = [n](Index i) { return (7 * i + 5) % n; };
    ASSERT_EQ(std::gcd(7, n), 1);
    Points initial(3, n), new_target(3, n);
    for (Index i = 0; i < n; ++i) {
      initial.col(moved(i)) = mesh.vertices.col(i);
      new_target.col(moved(i)) = target.col(i);
    }
    Faces faces(mesh.faces.rbegin(), mesh.faces.rend());
    for (auto& face : faces) {
      for (Index& i : face) i = moved(i);
      std::rotate(face.begin(), face.begin() + 1, face.end());
    }
    const std::vector<Points> plain = way(problem_of(mesh.vertices, mesh.faces, target), 20);
    std::vector<Points> renumbered = way(problem_of(initial, faces, new_target), 20);
    for (Points& x : renumbered) {
      Points back(3, n);
      for (Index i = 0; i < n; ++i) back.col(i) = x.col(moved(i));
      x = back;
    }
    EXPECT_LT(largest_difference(plain, renumbered), 1e-12) << name;  // of two sparse solves
  }
}

// What turns or mirrors both shapes turns or mirrors the way.
TEST(SheetMorph, GoesTheSameWayTurnedAndMirrored) {
  const Eigen::Matrix3d turn = Eigen::AngleAxis<double>(0.7, Vector3d::UnitY()).toRotationMatrix();
  const Eigen::Matrix3d mirror = Vector3d(1, 1, -1).asDiagonal();
  for (const auto& [name, mesh, target] : throws()) {
    std::vector<Points> plain = way(problem_of(mesh.vertices, mesh.faces, target), 20);
    for (const Eigen::Matrix3d& change : {turn, mirror}) {
      const Problem problem = problem_of(change * mesh.vertices, mesh.faces, change * target);
      std::vector<Points> changed = way(problem, 20);
      for (Points& x : changed) x = change.transpose() * x;
      EXPECT_LT(largest_difference(plain, changed), 1e-12) << name;  // of two sparse solves
    }
  }
}

TEST(SheetMorph, MirroredQuadsGoTheMirroredWay) {
  const FlatMesh mesh = grid(1, 1, 9, 9);
  const Points target = saddle(bent(mesh.vertices, 0.4, rolling(2)), 0.2);
  Faces other = mesh.faces;  // each begins a corner later: the other diagonal first
  for (auto& face : other) std::rotate(face.begin(), face.begin() + 1, face.end());
  EXPECT_LT(largest_difference(way(problem_of(mesh.vertices, mesh.faces, target), 20),
                               way(problem_of(mesh.vertices, other, target), 20)),
            1e-12);
}

TEST(SheetMorph, BeginsWithItsVelocityAndKeepsItContinuous) {
  const Throw one = throws()[4];
  for (const Arrival arrival : {Arrival::pass, Arrival::settle}) {
    const Problem problem = problem_of(one.mesh.vertices, one.mesh.faces, one.target, arrival);
    const double t0 = problem.arrival_time;
    const std::vector<Points> x = way(problem, 100'000);
    const Points start = SheetMorph(problem, 1e-5).velocity_at_start();
    const double h = 1e-5 * t0;
    // One-sided difference over 8 µs of accelerations of order 100 m/s².
    EXPECT_LT(((x[1] - x[0]) / h - start).colwise().norm().maxCoeff(), 2e-3);
    double jump = 0;
    for (std::size_t k = 1; k + 1 < x.size(); ++k) {
      jump = std::max(jump, (x[k + 1] - 2 * x[k] + x[k - 1]).colwise().norm().maxCoeff() / h);
    }
    EXPECT_LT(jump, 4e-3) << "m/s in a step";
    const double arrives = (x.back() - x[x.size() - 2]).norm() / h;
    if (arrival == Arrival::settle) {
      EXPECT_LT(arrives, 1e-4 * start.norm());
    } else {
      EXPECT_GT(arrives, 0.1 * start.norm());
    }
  }
}

// A target that is drawn as a line or a point is none a cloth can take, and must do no harm.
TEST(SheetMorph, StaysFiniteOnTheWayToATargetWithoutArea) {
  const FlatMesh mesh = grid(1, 1, 5, 5);
  Points line = mesh.vertices;
  line.row(2).setZero();
  for (const Points& target : {line, Points(1e-3 * line)}) {
    for (const Points& x : way(problem_of(mesh.vertices, mesh.faces, target), 20)) {
      EXPECT_TRUE(x.allFinite());
    }
  }
}

TEST(SheetMorph, IsTheReferenceOfASheet) {
  const Throw one = throws()[0];
  const Problem problem = problem_of(one.mesh.vertices, one.mesh.faces, one.target);
  ReferenceMotion motion(problem, problem.arrival_time / 64);
  SheetMorph morph(problem, 1.0 / 64);
  EXPECT_EQ(motion.velocity(), morph.velocity_at_start());
  for (int n = 0; n < 64; ++n) {
    EXPECT_EQ(motion.shape(), morph.shape());
    motion.advance();
    morph.advance();
  }
}

}  // namespace
}  // namespace nuno
