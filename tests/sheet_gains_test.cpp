// Sheets under several gains: the modes of a mesh, the law, its derivatives, the joint search.

#include <nuno/bullet.h>
#include <nuno/comparison.h>
#include <nuno/joint_search.h>
#include <nuno/native.h>
#include <nuno/rollout.h>
#include <nuno/shape_control.h>
#include <nuno/sheet_modes.h>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <numeric>

#include "gains_by_group.h"
#include "sheets.h"

namespace nuno {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using std::numbers::pi;

/// A throw of quads and triangles under damped control, and one of a disc under undamped.
Problem damped_problem() { return make_problem(throw_scene(false)); }
Problem undamped_problem() {
  SheetScene scene = reference_sheet("disc-to-oblique");
  scene.reference = Reference::morph;
  return make_problem(scene);
}

/// Gains of one to four groups, unlike each other.
std::vector<Gains> unlike_gains(const Problem& problem) {
  const double scale = gain_scale(problem);
  return {by_group({9 * scale}), by_group({3 * scale, 12 * scale}),
          by_group({20 * scale, 4 * scale, 7 * scale}),
          by_group({5 * scale, 30 * scale, 2 * scale, 11 * scale})};
}

Points pull_on(const Problem& problem, const Gains& gains, const Points& positions,
               const Points& velocities) {
  Points pulls;
  ShapeControl(problem, gains).pull(ReferenceMotion(problem, 1e-3), positions, velocities, pulls);
  return pulls;
}

/// The cotangent Laplacian by its cotangents: across from corner i of a triangle −½·cot i.
MatrixXd cotangent_laplacian(const Sheet& sheet) {
  MatrixXd result = MatrixXd::Zero(sheet.particles(), sheet.particles());
  for (Index t = 0; t < sheet.triangles.cols(); ++t) {
    for (Index i = 0; i < 3; ++i) {
      const Index at = sheet.triangles(i, t);
      const Index j = sheet.triangles((i + 1) % 3, t), k = sheet.triangles((i + 2) % 3, t);
      const Vector3d to_j = sheet.initial.col(j) - sheet.initial.col(at);
      const Vector3d to_k = sheet.initial.col(k) - sheet.initial.col(at);
      const double half = sheet.triangle_weight[t] * 0.5 * to_j.dot(to_k) / to_j.cross(to_k).norm();
      result(j, k) -= half;
      result(k, j) -= half;
      result(j, j) += half;
      result(k, k) += half;
    }
  }
  return result;
}

std::vector<Problem> meshes() {
  return {damped_problem(), make_problem(throw_scene(true)), undamped_problem()};
}

TEST(SheetModes, AreOrthonormalByMassAndBlindToThePlace) {
  for (const Problem& problem : meshes()) {
    const auto mass = problem.cloth().relative_mass.asDiagonal();
    const Points shapes = sheet_modes(problem.sheet(), 29).shapes;
    const MatrixXd products = shapes * mass * shapes.transpose();
    EXPECT_LT((products - MatrixXd::Identity(29, 29)).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((shapes * problem.cloth().relative_mass).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(SheetModes, AreTheLowestOfTheCotangentLaplacian) {
  for (const Problem& problem : meshes()) {
    const Sheet& sheet = problem.sheet();
    const MatrixXd laplacian = cotangent_laplacian(sheet);
    const MatrixXd mass = sheet.relative_mass.asDiagonal();
    const SheetModes found = sheet_modes(sheet, 29);
    const MatrixXd residual = laplacian * found.shapes.transpose() -
                              mass * found.shapes.transpose() * found.eigenvalues.asDiagonal();
    // Rounding of entries of order 4; the lowest eigenvalue is 0.1.
    EXPECT_LT(residual.cwiseAbs().maxCoeff(), 1e-12);
    const Vector all = Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(laplacian, mass)
                           .eigenvalues();  // none is missed; the first is that of the place
    EXPECT_LT((found.eigenvalues - all.segment(1, 29)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(SheetModes, OfASquareAreWavesAlongItsSides) {
  // On n × n points with half masses at the sides and quarters in the corners, cos(πpi/(n − 1)) is
  // exact along either axis, with 2 − 2·cos(πp/(n − 1)) in units of mean area over cell area.
  const Index n = 9;
  const Problem problem = make_problem(square(n, 0.7));
  std::vector<double> expected;
  const double cells = static_cast<double>(n - 1);
  for (Index p = 0; p < n; ++p) {
    for (Index q = 0; q < n; ++q) {
      expected.push_back((4 - 2 * std::cos(pi * static_cast<double>(p) / cells) -
                          2 * std::cos(pi * static_cast<double>(q) / cells)) *
                         cells * cells / static_cast<double>(n * n));
    }
  }
  std::ranges::sort(expected);
  const Vector found = sheet_modes(problem.sheet(), 20).eigenvalues;
  for (Index j = 0; j < 20; ++j) {
    EXPECT_NEAR(found[j], expected[static_cast<std::size_t>(j + 1)], 1e-13) << j;
  }
}

TEST(SheetModes, OfTheSmallestMeshesAreAllThereAre) {
  for (Index groups = 2; groups <= most_groups; ++groups) {
    const Index particles = fewest_sheet_particles(groups);
    // One mode beyond the last that a group may have, and N − 1 in all.
    EXPECT_LT(last_modes_of_sheet_group[static_cast<std::size_t>(groups - 2)].last + 1, particles);
    const Index columns = particles / 2 + particles % 2;
    SheetScene scene;  // a strip, one vertex more where the number is odd
    const Mesh strip = grid(columns, 2, 0.1, Tiles::triangles);
    scene.arrival_time = 1;
    scene.initial = scene.target = strip.vertices;
    scene.faces = strip.faces;
    const LowModes modes(make_problem(scene), groups);
    EXPECT_TRUE(modes.shapes.allFinite());
    EXPECT_EQ(modes.group.back(), groups - 2);
    EXPECT_LE(modes.count(), most_low_modes);
  }
}

TEST(SheetModes, StayTogetherWhereTheyAreTurnedIntoEachOther) {
  // On a square λ goes with p² + q² of the half waves along and across: 1, 1, 2; 4, 4, 5, 5, 8, 9,
  // 9, 10, 10; 13, … 20, 20; 25. A group ends where it grows, never within a pair.
  for (const bool quads : {true, false}) {
    const LowModes modes(make_problem(square(13, 1, quads)), most_groups);
    const SheetModes all = sheet_modes(make_problem(square(13, 1, quads)).sheet(), 29);
    ASSERT_EQ(modes.group.size(), static_cast<std::size_t>(modes.count()));
    EXPECT_EQ(std::ranges::count(modes.group, 0), 3);
    EXPECT_EQ(std::ranges::count(modes.group, 1), 9);
    EXPECT_EQ(std::ranges::count(modes.group, 2), 9);
    for (std::size_t j = 0; j < modes.group.size(); ++j) {
      const bool ends = j + 1 == modes.group.size() || modes.group[j] != modes.group[j + 1];
      const auto at = static_cast<Index>(j);
      if (!ends) continue;
      EXPECT_GT(all.eigenvalues[at + 1], 1.05 * all.eigenvalues[at]) << j;
    }
  }
}

TEST(SheetGroupedControl, OfOneGroupIsEquationThree) {
  for (const Problem& problem : {damped_problem(), undamped_problem()}) {
    const Points positions = problem.target * 1.3;
    const Points velocities = problem.cloth().initial;
    const ReferenceMotion reference(problem, 1e-3);
    const double gain = 0.7, mass = problem.cloth().particle_mass;
    const Vector center = problem.cloth().mass_center(positions);
    const Vector drift = problem.cloth().mass_center(velocities);
    Points expected = gain * (reference.shape() - (positions.colwise() - center));
    expected += shape_damping(problem.damping_ratio, gain, mass) *
                (reference.velocity() - (velocities.colwise() - drift));
    EXPECT_EQ(pull_on(problem, gain, positions, velocities), expected);
    for (Index groups = 2; groups <= most_groups; ++groups) {
      EXPECT_EQ(pull_on(problem, Gains(gain).split(groups), positions, velocities), expected);
    }
  }
}

TEST(SheetGroupedControl, HasNoNetForce) {
  for (const Problem& problem : {damped_problem(), undamped_problem()}) {
    for (const Gains& gains : unlike_gains(problem)) {
      const Points pulls =
          pull_on(problem, gains, problem.target * 1.3, 5 * problem.cloth().initial);
      Points forces;
      ShapeControl(problem, gains).to_forces(pulls, forces);
      EXPECT_GT(forces.norm(), 1e-3);
      // Rounding of a hundred forces of 1e-2 N.
      EXPECT_LT(forces.rowwise().sum().norm(), 1e-14);
    }
  }
}

TEST(SheetGroupedControl, PullsEveryModeWithTheGainOfItsGroup) {
  for (Problem problem : {damped_problem(), undamped_problem()}) {
    problem.reference = Reference::hold;
    problem.damping_ratio = 0.3;
    const std::vector<double> alphas = {0.2, 5, 3, 0.7};
    const LowModes low(problem, most_groups);
    const SheetModes all = sheet_modes(problem.sheet(), 29);
    for (Index j = 0; j < 29; ++j) {
      const auto at = static_cast<std::size_t>(j);
      const double alpha = alphas[j < low.count() ? static_cast<std::size_t>(low.group[at]) : 3];
      const Vector3d missing(0.1, -0.2, 0.3), drift(-3, 2, 1);
      const auto mode = all.shapes.row(j);
      const Points pulls =
          pull_on(problem, by_group(alphas), problem.target - missing * mode, drift * mode);
      const double beta =
          shape_damping(problem.damping_ratio, alpha, problem.cloth().particle_mass);
      // Modes of order 1 are good to 1e-12, and gains and rates of them of order 1.
      EXPECT_LT((pulls - (alpha * missing - beta * drift) * mode).cwiseAbs().maxCoeff(), 1e-11)
          << "mode " << j;
    }
  }
}

TEST(SheetGroupedRollouts, HaveTheSameBitsInTheBatchAndStepByStep) {
  for (const Problem& problem : {undamped_problem(), damped_problem()}) {
    const auto backend = native::make_backend(problem);
    for (const Gains& gains : unlike_gains(problem)) {
      Gains other = gains;
      other.rest *= 1.5;
      const std::vector<double> errors = backend->errors(std::vector<Gains>{gains, other});
      EXPECT_EQ(errors[0], rollout(*backend, gains).error.mean);
      EXPECT_EQ(errors[1], rollout(*backend, other).error.mean);
      EXPECT_EQ(backend->errors({&gains, 1}).front(), errors[0]);
      EXPECT_EQ(backend->error_samples({&gains, 1}).front().error, errors[0]);
    }
  }
}

TEST(SheetGroupedRollouts, WithEqualGainsArriveLikeOneGain) {
  const auto backend = native::make_backend(damped_problem());
  const double gain = 5 * gain_scale(backend->problem());
  const Rollout one = rollout(*backend, gain), four = rollout(*backend, Gains(gain).split(4));
  EXPECT_LT(farthest(one.final, four.final), 1e-12);
}

TEST(SheetGroupedRollouts, KnowTheDerivativeByEveryGain) {
  for (const Problem& problem : {undamped_problem(), damped_problem()}) {
    const auto backend = native::make_backend(problem);
    for (const Gains& gains : unlike_gains(problem)) expect_derivatives(*backend, gains);
  }
}

TEST(SheetGroupedRollouts, BringTheMassCentreHomeOnEveryEngine) {
  for (const Problem& problem : {undamped_problem(), damped_problem()}) {
    const auto native = native::make_backend(problem);
    for (const Gains& gains : unlike_gains(problem)) {
      // Rounding, a hundredth of the bar of 1e-9 L.
      EXPECT_LT(rollout(*native, gains).error.centroid, 1e-11 * problem.cloth().size);
    }
  }
  const Problem problem = damped_problem();
  const auto bullet = bullet::make_backend(problem);
  const Gains gains = unlike_gains(problem).back();
  const Rollout flight = rollout(*bullet, gains);
  EXPECT_LT(flight.error.centroid, 1e-9 * problem.cloth().size);
  const Points native = rollout(*native::make_backend(problem), gains).final;
  // What the engines differ by on calm flights, see docs/two-engines.md.
  EXPECT_LT(shape_difference(native, flight.final).mean, 1e-5 * problem.cloth().size);
}

/// The same sheet with its vertices in another order, `from` of each, and mirrored in x.
SheetScene renumbered(SheetScene scene, const std::vector<Index>& from) {
  std::vector<Index> to(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    to[static_cast<std::size_t>(from[i])] = static_cast<Index>(i);
  }
  for (auto& face : scene.faces) {
    for (Index& corner : face) corner = to[static_cast<std::size_t>(corner)];
    std::ranges::rotate(face, face.begin() + 1);
  }
  std::ranges::reverse(scene.faces);
  const Points initial = scene.initial(Eigen::all, from), target = scene.target(Eigen::all, from);
  scene.initial = initial;
  scene.target = target;
  scene.initial.row(0) *= -1;
  scene.target.row(0) *= -1;
  return scene;
}

TEST(SheetGroupedRollouts, OfARenumberedAndMirroredMeshAreTheMirroredFlights) {
  std::vector<SheetScene> scenes = {throw_scene(true), throw_scene(false),
                                    reference_sheet("disc-to-oblique")};
  scenes[2].reference = Reference::morph;
  scenes[2].damping_ratio = 0.7;
  for (const SheetScene& scene : scenes) {
    std::vector<Index> from(static_cast<std::size_t>(scene.initial.cols()));
    std::iota(from.begin(), from.end(), 0);
    const auto n = static_cast<Index>(from.size());
    for (Index& i : from) i = (i * 29 + 11) % n;  // 29 divides neither 81 nor 127
    const Problem problem = make_problem(scene);
    for (const Gains& gains : unlike_gains(problem)) {
      const Points one = rollout(*native::make_backend(problem), gains).final;
      Points other =
          rollout(*native::make_backend(make_problem(renumbered(scene, from))), gains).final;
      other.row(0) *= -1;
      EXPECT_LT(farthest(one(Eigen::all, from), other), 1e-9 * problem.cloth().size)
          << gains.count() << " gains";
    }
  }
}

TEST(SheetJointSearch, IsNeverWorseThanTheStageBefore) {
  for (const Problem& problem : {undamped_problem(), damped_problem()}) {
    const auto backend = native::make_backend(problem);
    const OptimizeSummary one = global_search(objective(*backend));
    const JointSearchSummary found =
        joint_search(joint_objective(*backend), {one.gain, one.error},
                     {.groups = most_groups, .scan = 8, .valleys = 1, .rounds = 4});
    ASSERT_EQ(found.stages.size(), 4u);
    EXPECT_EQ(found.stages[0].error, one.error);
    for (std::size_t k = 1; k < 4; ++k) {
      EXPECT_LE(found.stages[k].error, found.stages[k - 1].error);
      EXPECT_EQ(rollout(*backend, found.stages[k].gains).error.mean, found.stages[k].error);
    }
  }
}

}  // namespace
}  // namespace nuno
