// Gains by group of modes: the law, its derivatives, the joint search.

#include <nuno/gains.h>
#include <nuno/joint_search.h>
#include <nuno/rollout.h>
#include <nuno/shape_control.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engines.h"
#include "gains_by_group.h"
#include "scene_library.h"

namespace nuno {
namespace {

constexpr Index N = 32;

/// A throw under the paper's hold, and one under the damped morph.
Problem hold_problem() { return make_problem(scene_library::straight_to_s()); }
Problem morph_problem() {
  ChainScene scene = scene_library::figure_throws()[4];
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  return make_problem(scene);
}

double gain_scale(const Problem& problem) {
  return problem.chain().particle_mass / (problem.arrival_time * problem.arrival_time);
}

/// Gains of one to four groups, unlike each other.
std::vector<Gains> unlike_gains(const Problem& problem) {
  const double scale = gain_scale(problem);
  return {by_group({9 * scale}), by_group({3 * scale, 12 * scale}),
          by_group({20 * scale, 4 * scale, 7 * scale}),
          by_group({5 * scale, 30 * scale, 2 * scale, 11 * scale})};
}

Points force_on(const Problem& problem, const Gains& gains, const Points& positions,
                const Points& velocities) {
  Points forces;
  ShapeControl(problem, gains).pull(ReferenceMotion(problem, 1e-3), positions, velocities, forces);
  return forces;
}

TEST(LowModes, AreOrthonormalAndBlindToThePlace) {
  const LowModes modes(N, most_groups);
  ASSERT_EQ(modes.count(), last_mode_of_group.back());
  const Eigen::MatrixXd products = modes.shapes * modes.shapes.transpose();
  EXPECT_LT((products - Eigen::MatrixXd::Identity(11, 11)).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT(modes.shapes.rowwise().sum().cwiseAbs().maxCoeff(), 1e-14);
}

TEST(LowModes, ChangeSignOnceMoreEach) {
  const LowModes modes(N, 3);
  ASSERT_EQ(modes.count(), 5);
  for (Index j = 0; j < modes.count(); ++j) {
    Index changes = 0;
    for (Index i = 1; i < N; ++i) changes += modes.shapes(j, i) * modes.shapes(j, i - 1) < 0;
    EXPECT_EQ(changes, j + 1);
    EXPECT_EQ(modes.group[static_cast<std::size_t>(j)], j < 2 ? 0 : 1);
  }
}

TEST(LowModes, FillEveryGroupWithTheFewestParticles) {
  for (Index groups = 2; groups <= most_groups; ++groups) {
    const Index particles = fewest_particles(groups);
    // All modes but one, so that the last group has one too.
    EXPECT_EQ(LowModes(particles, groups).count(), particles - 2);
  }
}

TEST(GroupedControl, WithEqualGainsIsThatOfOneGain) {
  const Problem problem = morph_problem();
  const Points positions = problem.target * 1.3;
  const Points velocities = problem.chain().initial;
  const Points one = force_on(problem, 0.7, positions, velocities);
  for (Index groups = 2; groups <= most_groups; ++groups) {
    EXPECT_EQ(force_on(problem, Gains(0.7).split(groups), positions, velocities), one);
  }
}

TEST(GroupedControl, HasNoNetForce) {
  for (const Problem& problem : {hold_problem(), morph_problem()}) {
    for (const Gains& gains : unlike_gains(problem)) {
      const Points force = force_on(problem, gains, problem.target * 1.3, problem.chain().initial);
      EXPECT_GT(force.norm(), 1e-3);
      EXPECT_LT(force.rowwise().sum().norm(), 1e-14);  // rounding of 32 forces of 1e-2 N
    }
  }
}

TEST(GroupedControl, PullsEveryModeWithTheGainOfItsGroup) {
  Problem problem = hold_problem();
  problem.damping_ratio = 0.3;
  const double mass = problem.chain().particle_mass;
  const std::vector<double> alphas = {0.2, 5, 0.7};
  const Gains gains = by_group(alphas);
  for (Index j = 1; j < N; ++j) {
    Eigen::RowVectorXd mode(N);
    for (Index i = 0; i < N; ++i) {
      mode[i] = std::cos(std::numbers::pi * static_cast<double>(j) *
                         (static_cast<double>(i) + 0.5) / static_cast<double>(N));
    }
    const double alpha = alphas[j <= 2 ? 0 : j <= 5 ? 1 : 2];
    const Eigen::Vector2d residual(0.1, -0.2), drift(-3, 2);
    const Points force = force_on(problem, gains, problem.target - residual * mode, drift * mode);
    const Points expected =
        (alpha * residual - shape_damping(problem.damping_ratio, alpha, mass) * drift) * mode;
    EXPECT_LT((force - expected).cwiseAbs().maxCoeff(), 1e-14) << "mode " << j;
  }
}

TEST(GroupedControl, SwingsAModeAtTheFrequencyOfItsGroup) {
  // A straight cloth without weight, drag or hinges, and a target that differs from it across by a
  // little of one mode: its particles are springs of their own, yₙ = A·(1 − cos(n·ω'h)) with the
  // leapfrog's sin(ω'h/2) = √(α/m)·h/2.
  const std::vector<double> turns = {1, 7, 20};  // √(α/m)·t₀ of the groups [rad]
  for (const Index j : {1, 2, 3, 5, 6, 20}) {
    ChainScene scene = scene_library::straight_to_s();
    scene.initial.row(1).setZero();  // so that rounding across is of the mode's own size
    scene.target = scene.initial;
    scene.gravity = 0;
    scene.cloth.air_drag = 0;
    scene.cloth.hinge_stiffness = 0;
    Problem problem = make_problem(scene);
    const double amplitude = 1e-7;
    Eigen::RowVectorXd mode(N);
    for (Index i = 0; i < N; ++i) {
      mode[i] = amplitude * std::cos(std::numbers::pi * static_cast<double>(j) *
                                     (static_cast<double>(i) + 0.5) / static_cast<double>(N));
    }
    problem.target.row(1) += mode;
    std::vector<double> alphas;
    for (const double turn : turns) alphas.push_back(turn * turn * gain_scale(problem));
    const Gains gains = by_group(alphas);

    const auto backend = native::make_backend(problem);
    const auto cloth = backend->start(Points::Zero(2, N));
    const ReferenceMotion reference(problem, backend->time_step());
    const ShapeControl control(problem, gains);
    Points forces;
    for (Index n = 0; n < backend->steps(); ++n) {
      control.pull(reference, cloth->positions(), cloth->velocities(), forces);
      cloth->step(forces);
    }
    const double h = backend->time_step();
    const double turn = turns[j <= 2 ? 0 : j <= 5 ? 1 : 2];
    const double phase = 2 * std::asin(0.5 * turn * h) / h;  // t₀ is 1 s
    const Eigen::RowVectorXd y = cloth->positions().row(1) - problem.chain().initial.row(1);
    // Segments that tilt by 1e-6 stretch by 1e-12 of their length.
    EXPECT_LT((y - (1 - std::cos(phase)) * mode).norm(), 1e-7 * mode.norm()) << "mode " << j;
  }
}

TEST(GroupedRollouts, HasTheSameBitsInTheBatchAndStepByStep) {
  for (const Problem& problem : {hold_problem(), morph_problem()}) {
    const auto backend = native::make_backend(problem);
    for (const Gains& gains : unlike_gains(problem)) {
      Gains other = gains;
      other.rest *= 1.5;
      const std::vector<double> errors = backend->errors(std::vector<Gains>{gains, other});
      EXPECT_EQ(errors[0], rollout(*backend, gains).error.mean);
      EXPECT_EQ(errors[1], rollout(*backend, other).error.mean);
    }
  }
}

TEST(GroupedRollouts, OfOneGroupIsTheFlightOfOneGain) {
  const auto backend = native::make_backend(morph_problem());
  const std::vector<double> alphas = {0.1, 0.7};
  const std::vector<Gains> gains(alphas.begin(), alphas.end());
  EXPECT_EQ(backend->errors(gains), backend->errors(alphas));
  const std::vector<ErrorSample> of_one = backend->error_samples(alphas);
  const std::vector<ErrorSample> of_groups = backend->error_samples(gains);
  for (std::size_t i = 0; i < alphas.size(); ++i) {
    EXPECT_EQ(of_groups[i].error, of_one[i].error);
    ASSERT_EQ(of_groups[i].derivatives.size(), 1u);
    EXPECT_EQ(of_groups[i].derivatives[0].error, of_one[i].derivatives[0].error);
  }
}

TEST(GroupedRollouts, WithEqualGainsArrivesLikeOneGain) {
  for (const Problem& problem : {hold_problem(), morph_problem()}) {
    const auto backend = native::make_backend(problem);
    const double gain = 5 * gain_scale(problem);
    const Rollout one = rollout(*backend, gain);
    const Rollout four = rollout(*backend, Gains(gain).split(4));
    EXPECT_LT((one.final - four.final).norm(), 1e-12);
    EXPECT_EQ(four.gains.groups(), std::vector<double>(4, gain));
  }
}

TEST(GroupedRollouts, KnowsTheDerivativeByEveryGain) {
  for (const Problem& problem : {hold_problem(), morph_problem()}) {
    const auto backend = native::make_backend(problem);
    for (const Gains& gains : unlike_gains(problem)) expect_derivatives(*backend, gains);
  }
}

TEST(GroupedRollouts, BringsTheCentroidHomeOnEveryEngine) {
  const Problem problem = hold_problem();
  for (const Engine& engine : {native_engine, box2d_weld_engine}) {
    const auto backend = engine.make(problem, std::nullopt);
    for (const Gains& gains : unlike_gains(problem)) {
      EXPECT_LT(rollout(*backend, gains).error.centroid, engine.rounding) << engine.name;
    }
  }
}

TEST(GroupedRollouts, EndsInTheSameShapeOnBothEngines) {
  ChainScene scene = scene_library::straight_to_s();
  scene.launch = Launch::inextensible;
  const Problem problem = make_problem(scene);
  for (const Gains& gains : unlike_gains(problem)) {
    const Points one = rollout(*make_native(problem, 1e-4), gains).final;
    const Points other = rollout(*box2d::make_backend(problem), gains).final;
    // What the engines differ by on calm scenes, see docs/two-engines.md.
    EXPECT_LT(shape_difference(one, other).mean, 1e-3 * problem.chain().size);
  }
}

// ---- the joint search ------------------------------------------------------------------------

/// A bowl in log α, narrow across its axes: best at 2, 8 and 0.5 N/m.
template <typename Function>
JointObjective made_of(Function error) {
  JointObjective objective;
  objective.errors = [error](std::span<const Gains> all) {
    std::vector<double> errors;
    for (const Gains& gains : all) errors.push_back(error(gains.groups()));
    return errors;
  };
  objective.largest_gain = 1e3;
  return objective;
}

double bowl(const std::vector<double>& groups) {
  const double x = std::log(groups.front() / 2);
  const double y = std::log(groups[groups.size() > 1 ? 1 : 0] / 8);
  const double z = std::log(groups.back() / 0.5);
  return 0.3 + x * x + std::pow(y - x, 2) + 9 * std::pow(z + y, 2);
}

TEST(JointSearch, FindsTheBottomOfABowl) {
  const JointObjective objective = made_of(bowl);
  const JointSearchSummary found = joint_search(objective, {1, bowl({1})}, {.groups = 3});
  ASSERT_EQ(found.stages.size(), 3u);
  EXPECT_EQ(found.status, OptimizeStatus::converged);
  const std::vector<double> best = found.stages.back().gains.groups();
  ASSERT_EQ(best.size(), 3u);
  // The error's tolerance of 1e-6 is one of 1e-3 in log α.
  EXPECT_NEAR(best[0], 2, 0.01);
  EXPECT_NEAR(best[1], 8, 0.03);
  EXPECT_NEAR(best[2], 0.5, 0.003);
}

TEST(JointSearch, IsNeverWorseThanTheStageBefore) {
  for (ChainScene scene : {scene_library::straight_to_s(), scene_library::family_member(3),
                           scene_library::family_member(7)}) {
    for (const bool morph : {false, true}) {
      scene.reference = morph ? Reference::morph : Reference::hold;
      scene.damping_ratio = morph ? 0.7 : 0;
      const auto backend = native::make_backend(make_problem(scene));
      const OptimizeSummary one = global_search(objective(*backend));
      const JointSearchSummary found =
          joint_search(joint_objective(*backend), {one.gain, one.error},
                       {.groups = 3, .valleys = 1, .rounds = 10});
      ASSERT_EQ(found.stages.size(), 3u);
      EXPECT_EQ(found.stages[0].error, one.error);
      for (std::size_t k = 1; k < 3; ++k) {
        EXPECT_LE(found.stages[k].error, found.stages[k - 1].error);
        EXPECT_EQ(rollout(*backend, found.stages[k].gains).error.mean, found.stages[k].error);
      }
    }
  }
}

TEST(JointSearch, TakesAThirdOfTheErrorOfTheSCurveWithASecondGain) {
  const auto backend = native::make_backend(hold_problem());
  const OptimizeSummary one = global_search(objective(*backend));
  const JointSearchSummary found = joint_search(joint_objective(*backend), {one.gain, one.error});
  EXPECT_LT(found.stages[1].error, 0.7 * one.error);  // see docs/coefficients.md
}

TEST(JointSearch, DoesWithoutGradients) {
  const auto backend = native::make_backend(hold_problem());
  constexpr double calm = 100;  // gain scales; beyond, one way or the other ends in another valley
  const OptimizeSummary one = global_search(objective(*backend), {.largest_gain = calm});
  JointObjective with = joint_objective(*backend);
  with.largest_gain = calm * with.gain_scale;
  JointObjective without = with;
  without.samples = nullptr;
  const double exact = joint_search(with, {one.gain, one.error}).stages.back().error;
  const double differences = joint_search(without, {one.gain, one.error}).stages.back().error;
  EXPECT_LE(differences, one.error);
  EXPECT_NEAR(differences / exact, 1, 1e-3);
}

TEST(JointSearch, StaysWithinItsBounds) {
  JointObjective objective = made_of(
      [](const std::vector<double>& groups) { return 1 / (1 + groups.front()) + groups.back(); });
  objective.largest_gain = 7;
  const auto errors = objective.errors;
  objective.errors = [&](std::span<const Gains> all) {
    for (const Gains& gains : all) EXPECT_LE(gains.largest(), 7);
    return errors(all);
  };
  const Gains best = joint_search(objective, {1, 1.5}).stages.back().gains;
  EXPECT_NEAR(best.low.front(), 7, 1e-9);
  EXPECT_NEAR(best.rest, JointSearchOptions().smallest_gain, 1e-9);
}

TEST(JointSearch, KeepsOneGainWhereMoreBuyNothing) {
  const JointObjective objective =
      made_of([](const std::vector<double>& groups) { return 1 + groups.front() + groups.back(); });
  const JointSearchSummary found = joint_search(objective, {0, 1});
  EXPECT_EQ(found.stages.back().gains.count(), 1);
  EXPECT_EQ(found.stages.back().gains.rest, 0);
  EXPECT_EQ(found.stages.back().error, 1);
}

TEST(JointSearch, SurvivesAnEngineThatAlwaysDiverges) {
  const double infinity = std::numeric_limits<double>::infinity();
  const JointObjective objective = made_of([=](const std::vector<double>&) { return infinity; });
  const JointSearchSummary found = joint_search(objective, {1, infinity}, {.groups = 3});
  EXPECT_EQ(found.stages.back().error, infinity);
  EXPECT_EQ(found.stages.back().gains.groups(), std::vector<double>{1});
}

TEST(JointSearch, CountsItsRollouts) {
  Index rollouts = 0;
  JointObjective objective = made_of(bowl);
  const auto errors = objective.errors;
  objective.errors = [&](std::span<const Gains> all) {
    rollouts += static_cast<Index>(all.size());
    return errors(all);
  };
  EXPECT_EQ(joint_search(objective, {1, bowl({1})}).evaluations, rollouts);
}

}  // namespace
}  // namespace nuno
