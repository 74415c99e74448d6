// Refinement of sheets: lands them on what cloth can be, and says where it stops.

#include <nuno/bullet.h>
#include <nuno/native.h>
#include <nuno/refine.h>
#include <nuno/sheet_stiffness.h>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "sheets.h"

namespace nuno {
namespace {

/// Bends a flat grid of square cells about the z axis by a turn of each column of cells, so that
/// every edge keeps its length to rounding, and puts it elsewhere.
Points bent(const Mesh& grid, Index columns, double spacing,
            const std::function<double(double)>& turn) {
  Points result = grid.vertices;
  Eigen::Vector2d at(2, 1);
  for (Index i = 0; i < columns; ++i) {
    for (Index v = i; v < result.cols(); v += columns) result.col(v).head<2>() = at;
    const double angle = turn((static_cast<double>(i) + 0.5) / static_cast<double>(columns - 1));
    at += spacing * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  result.row(2).array() += 0.7;
  return result;
}

double half_pipe(double s) { return std::numbers::pi * (s - 0.5); }
double s_curve(double s) { return 1.5 * std::sin(2 * std::numbers::pi * s); }

/// A square of cloth and a target that is one, under damped `morph`.
Problem reachable(const std::function<double(double)>& turn, Tiles tiles = Tiles::quads,
                  const SheetMaterial& material = {}) {
  constexpr Index columns = 10;
  constexpr double spacing = 0.09;
  const Mesh mesh = grid(columns, columns, spacing, tiles);
  SheetScene scene;
  scene.arrival_time = 1;
  scene.initial = mesh.vertices;
  scene.target = bent(mesh, columns, spacing, turn);
  scene.faces = mesh.faces;
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  scene.cloth = material;
  return make_problem(scene);
}

RefineSummary refined(const Problem& problem, const RefineOptions& options = {}) {
  const double gain = tracking_gain(*native::make_backend(problem));
  return refine(problem, gain, native::make_backend, native::make_backend, options);
}

/// A target that no cloth can be: stretched along one side as the other keeps its length.
Problem beyond_reach(double stretch = 0.02) {
  Problem problem = reachable(half_pipe);
  for (Index i = 0; i < problem.target.cols(); ++i) {
    problem.target.col(i).head<2>() *= 1 + stretch * problem.target(2, i);
  }
  return problem;
}

TEST(SheetRefine, LandsOnWhateverClothCanBe) {
  SheetMaterial cotton;
  cotton.stretch_stiffness = 4000;
  cotton.shear_stiffness = 500;
  for (const auto& turn : {half_pipe, s_curve}) {
    for (const Tiles tiles : {Tiles::quads, Tiles::mixed, Tiles::triangles}) {
      for (const SheetMaterial& material : {SheetMaterial(), cotton}) {
        const Problem problem = reachable(turn, tiles, material);
        const RefineSummary summary = refined(problem);
        EXPECT_TRUE(summary.converged) << summary.reason;
        EXPECT_LE(summary.flight.error.mean, 1e-6 * problem.cloth().size);
        EXPECT_GT(summary.error_before, 1e-4 * problem.cloth().size);
        EXPECT_LE(summary.rollouts, 25);
        // Control still corrects shape alone.
        EXPECT_LE(summary.flight.error.centroid, 1e-9 * problem.cloth().size);
      }
    }
  }
}

TEST(SheetRefine, IsFlownAgainByItsReferenceCorrection) {
  Problem problem = reachable(s_curve);
  const RefineSummary summary = refined(problem);
  problem.reference_correction = summary.reference_correction;
  const Rollout again = rollout(*native::make_backend(problem), summary.flight.gains);
  EXPECT_EQ(again.final, summary.flight.final);
  // A second refinement has nothing to do.
  EXPECT_EQ(refined(problem).rollouts, 1);
}

TEST(SheetRefine, ComesOutOfReachAsNearAsIsWorthIt) {
  const Problem problem = beyond_reach();
  const RefineSummary summary = refined(problem);
  EXPECT_FALSE(summary.converged);
  EXPECT_LT(summary.flight.error.mean, 0.5 * summary.error_before);
  EXPECT_NE(summary.reason.find("do not fit"), std::string::npos) << summary.reason;
}

TEST(SheetRefine, NeverLosesWhatItHas) {
  const auto cost = [](const Problem& problem, const Rollout& flight) {
    return std::hypot(flight.control_effort, 1e4 * flight.error.mean / problem.cloth().size);
  };
  const Problem within = reachable([](double s) { return 5 * s; }), beyond = beyond_reach(0.003);
  double error = std::numeric_limits<double>::infinity(), spent = error;
  for (Index rounds = 1; rounds <= 24; rounds += rounds < 8 ? 1 : 4) {
    const RefineSummary nearer = refined(within, {.rounds = rounds});
    EXPECT_LE(nearer.flight.error.mean, error);
    error = nearer.flight.error.mean;
    // Out of reach an error of 1e-4·L is worth a particle's weight.
    const double now = cost(beyond, refined(beyond, {.rounds = rounds}).flight);
    EXPECT_LE(now, spent);
    spent = now;
  }
}

TEST(SheetRefine, KeepsTheEffortLimit) {
  const Problem problem = reachable(s_curve);
  const double gain = tracking_gain(*native::make_backend(problem));
  const double least = rollout(*native::make_backend(problem), gain).control_effort;
  const double most = refined(problem).flight.control_effort;
  ASSERT_GT(most, 1.05 * least);
  const double limit = (least + most) / 2;
  const RefineSummary summary = refined(problem, {.effort_limit = limit});
  EXPECT_LE(summary.flight.control_effort, limit);
  EXPECT_LT(summary.flight.error.mean, summary.error_before);
  EXPECT_FALSE(summary.converged);

  const RefineSummary none = refined(problem, {.effort_limit = 0.5 * least});
  EXPECT_FALSE(none.converged);
  EXPECT_EQ(none.reason, "no flight of so little effort was found");
}

TEST(SheetRefine, IsNeverWorseThanTheFirstFlight) {
  Problem problem = beyond_reach();
  for (const Reference reference : {Reference::hold, Reference::morph}) {
    for (const double damping_ratio : {0.0, 0.7}) {
      problem.reference = reference;
      problem.damping_ratio = damping_ratio;
      const RefineSummary summary = refined(problem, {.rounds = 8});
      EXPECT_LE(summary.flight.error.mean, summary.error_before);
      EXPECT_LE(summary.rollouts, 9);
    }
  }
}

TEST(SheetRefine, TransfersToAnEngineThatKnowsNothingOfIt) {
  const Problem problem = reachable(half_pipe);
  const RefineSummary answer = refined(problem);
  const RefineSummary there =
      transfer(problem, answer, bullet::make_backend, native::make_backend, {});
  EXPECT_TRUE(there.converged) << there.reason;
  EXPECT_LE(there.flight.error.mean, 1e-5 * problem.cloth().size);
}

TEST(SheetRefine, StopsWhenAsked) {
  Problem problem = reachable(half_pipe);
  std::stop_source stop;
  problem.stop = stop.get_token();
  stop.request_stop();
  EXPECT_THROW(refined(problem), Stopped);
}

// ---- the stiffness matrix ---------------------------------------------------------------------

TEST(SheetStiffness, IsTheForceThatASmallDisplacementCallsForth) {
  for (const Tiles tiles : {Tiles::quads, Tiles::mixed}) {
    Mesh mesh = grid(6, 5, 0.1, tiles);
    mesh.vertices = rolled(mesh.vertices, 1.5);
    Problem problem = problem_of(mesh, without_losses());
    problem.reference = Reference::hold;
    problem.time_step = 1e-5;
    const auto backend = native::make_backend(problem);
    const Sheet& sheet = problem.sheet();
    Points displacement(3, sheet.particles());
    for (Index i = 0; i < displacement.size(); ++i) {
      displacement.data()[i] = std::sin(1.3 * static_cast<double>(i + 1));
    }
    // The first step moves by h²/2·M⁻¹·f. Central differences take even orders away.
    const double h = backend->time_step(), size = 1e-6;
    Points moved[2];
    for (const int side : {0, 1}) {
      const Points from = sheet.initial + (side == 0 ? -size : size) * displacement;
      const auto cloth = backend->start(from, Points::Zero(3, sheet.particles()));
      cloth->step(Points::Zero(3, sheet.particles()));
      moved[side] = cloth->positions() - from;
    }
    Points forces = (moved[1] - moved[0]) / (2 * size) * (2 / (h * h)) * sheet.particle_mass;
    forces.array().rowwise() *= sheet.relative_mass.transpose().array();
    const Vector expected = -stiffness_matrix(sheet, sheet.initial) * displacement.reshaped();
    EXPECT_LT((forces.reshaped() - expected).norm(), 1e-4 * expected.norm());
  }
}

TEST(SheetStiffness, LetsRigidMotionsBe) {
  Mesh mesh = grid(6, 5, 0.1, Tiles::mixed);
  mesh.vertices = rolled(mesh.vertices, 1.5);
  const Problem problem = problem_of(mesh);
  const Sheet& sheet = problem.sheet();
  const Eigen::SparseMatrix<double> stiffness = stiffness_matrix(sheet, sheet.initial);
  for (Index axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
    const Points shift = unit.replicate(1, sheet.particles());
    Points turn(3, sheet.particles());
    for (Index i = 0; i < turn.cols(); ++i) {
      turn.col(i) = unit.cross(sheet.initial.col(i).head<3>());
    }
    EXPECT_LT((stiffness * shift.reshaped()).norm(), 1e-9 * stiffness.norm());
    EXPECT_LT((stiffness * turn.reshaped()).norm(), 1e-9 * stiffness.norm());
  }
  const Eigen::SparseMatrix<double> transposed = stiffness.transpose();
  EXPECT_LT((stiffness - transposed).norm(), 1e-14 * stiffness.norm());
}

}  // namespace
}  // namespace nuno
