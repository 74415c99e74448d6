// Refinement of a cloth that answers corrections in proportion, so that every flight is known.

#include <nuno/refine.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scripted_engine.h"

namespace nuno {
namespace {

constexpr Index steps = 4;
constexpr double gain = 1;

/// A cloth of the shape `cross`, S, that arrives off its target by r·S + δ and is held by forces
/// f·S − δ on its way, δ the correction of the first power. Under δ = −s·S it has the mean error
/// |r − s| and the effort |f + s|: every bit of error costs as much effort.
struct Proportional {
  double error = 0;        ///< r [m]
  double effort = 0;       ///< f
  double model_sign = -1;  ///< what its model takes the derivative of the forces for
};

Problem problem_of_cross() {
  Problem problem = problem_of(cross());
  problem.target = cross().colwise() + Eigen::Vector2d(1, 2);
  return problem;
}

/// L of that problem's cloth.
const double length = 3 * std::sqrt(2);

MakeBackend engine_of(const Proportional& cloth) {
  return [=](const Problem& problem) {
    Points first = Points::Zero(2, 4);
    if (!problem.reference_correction.empty()) first = problem.reference_correction.front();
    const Points force = cloth.effort * cross() - first;
    // The control force is α·(reference − cloth): the cloth is as far off as that takes. Before the
    // first of the steps it is not off yet.
    const double off = effort_unit(problem) / gain * std::sqrt(steps / (steps - 1.0));
    const Points target = problem.target;
    auto engine =
        std::make_unique<ScriptedBackend>(problem, steps, [=](const Moment& now) -> Points {
          if (now.step == steps) return target + cloth.error * cross() + first;
          return target + static_cast<double>(now.step) / steps * first - off * force;
        });
    engine->jacobian_of = [=](const CorrectionDirections& along) {
      RolloutJacobian jacobian;
      jacobian.arrival = along.shapes;
      for (std::size_t d = 0; d < along.powers.size(); ++d) {
        if (along.powers[d] != 0) jacobian.arrival.col(static_cast<Index>(d)).setZero();
      }
      const double share = 1 / std::sqrt(4.0);  // of a particle in the root mean square
      jacobian.forces = share * force.reshaped();
      jacobian.forces_jacobian = cloth.model_sign * share * jacobian.arrival;
      return jacobian;
    };
    return engine;
  };
}

RefineSummary refined(const Proportional& cloth, const RefineOptions& options,
                      const Problem& problem = problem_of_cross()) {
  return refine(problem, gain, engine_of(cloth), engine_of(cloth), options);
}

/// The error that is left in the Pareto optimum of effort² + weight²·(error/L)², where error falls
/// by what effort rises: with q = (weight/L)², s = (q·r − f)/(1 + q).
double left_at(double weight, const Proportional& cloth) {
  const double q = std::pow(weight / length, 2);
  return (cloth.error + cloth.effort) / (1 + q);
}

// A step is damped by a thousandth of the size of the forces, squared.
constexpr double damping = 2e-6;

TEST(RefineExactly, KnowsTheScriptedFlight) {
  const Proportional cloth = {.error = 0.3, .effort = 0.2};
  Problem problem = problem_of_cross();
  for (const double s : {0.0, 0.1}) {
    problem.reference_correction.assign(4, Points::Zero(2, 4));
    problem.reference_correction[0] = -s * cross();
    const Rollout flight = rollout(*engine_of(cloth)(problem), gain);
    EXPECT_NEAR(flight.error.mean, 0.3 - s, 1e-14);
    EXPECT_NEAR(flight.control_effort, 0.2 + s, 1e-14);
  }
}

// Both count alike there, which is where effort is to be spared.
TEST(RefineExactly, StartsWithTheWeightAtWhichEffortAndErrorAreEqual) {
  const Proportional cloth = {.error = 0.5, .effort = 0.4};
  const RefineSummary summary = refined(cloth, {.rounds = 1});
  const double weight = 0.4 * length / 0.5;
  EXPECT_EQ(summary.rollouts, 2);
  EXPECT_NEAR(summary.error_before, 0.5, 1e-14);
  EXPECT_NEAR(summary.flight.error.mean, left_at(weight, cloth), damping);
  EXPECT_EQ(summary.reason, "1 rounds were not enough");
}

TEST(RefineExactly, StartsWhereEffortCountsHoweverNearItIs) {
  const Proportional cloth = {.error = 0.05, .effort = 0.6};  // both are equal at a weight of 51
  EXPECT_NEAR(refined(cloth, {.rounds = 1}).flight.error.mean, left_at(30, cloth), damping);
}

TEST(RefineExactly, StartsWithLessWeightUnderAnEffortLimit) {
  const Proportional cloth = {.error = 0.5, .effort = 0.4};
  EXPECT_NEAR(refined(cloth, {.effort_limit = 10, .rounds = 1}).flight.error.mean,
              left_at(1, cloth), damping);
}

TEST(RefineExactly, CorrectsAnAnswerOfBeforeWhereItStands) {
  const Proportional cloth = {.error = 0.05, .effort = 0.6};
  Problem problem = problem_of_cross();
  problem.reference_correction.assign(4, Points::Zero(2, 4));
  const double weight = 0.6 * length / 0.05;
  EXPECT_NEAR(refined(cloth, {.rounds = 1}, problem).flight.error.mean, left_at(weight, cloth),
              damping);
}

TEST(RefineExactly, ArrivesByOneJacobianWhereItForetellsEveryFlight) {
  const Proportional cloth = {.error = 0.5, .effort = 0.4};
  const RefineSummary summary = refined(cloth, {});
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(summary.jacobians, 1);
  EXPECT_LE(summary.flight.error.mean, 1e-9 * length);
  EXPECT_NEAR(summary.flight.control_effort, 0.9, 1e-8);
  EXPECT_LT((summary.reference_correction[0] + 0.5 * cross()).norm(), 1e-8);
  EXPECT_EQ(summary.reason, "arrived within the tolerance");
}

TEST(RefineExactly, EndsAtItsEffortLimit) {
  // From a plain flight within it: limits of little more effort than that takes, and of nearly all
  // that arrives.
  const Proportional cloth = {.error = 0.5, .effort = 0.05};
  for (const double limit : {0.1, 0.2, 0.4, 0.54}) {
    const RefineSummary summary = refined(cloth, {.effort_limit = limit});
    EXPECT_FALSE(summary.converged) << limit;
    EXPECT_LE(summary.flight.control_effort, limit);
    EXPECT_GT(summary.flight.control_effort, 0.9 * limit);
    EXPECT_EQ(summary.reason, "more would take more effort than the limit") << limit;
  }
  EXPECT_TRUE(refined(cloth, {.effort_limit = 0.56}).converged);
}

TEST(RefineExactly, LowersTheEffortOfAFlightThatIsOverItsLimit) {
  const Proportional cloth = {.error = -0.5, .effort = 0.9};  // less effort comes nearer, too
  const RefineSummary summary = refined(cloth, {.effort_limit = 0.5});
  EXPECT_TRUE(summary.converged);
  EXPECT_NEAR(summary.flight.control_effort, 0.4, 1e-8);
  const Proportional stuck = {.error = 0.01, .effort = 0.9};
  EXPECT_EQ(refined(stuck, {.effort_limit = 1e-3, .rounds = 2}).reason,
            "no flight of so little effort was found");
}

// The model foretells less effort where there is more, so no step that spares effort holds what it
// promised; from nearer than 1e-3·L, the rest of the error alone is removed.
TEST(RefineExactly, LandsWhereTheJacobianOfTheEffortIsWrong) {
  const Proportional near = {.error = 0.9e-3 * length, .effort = 1, .model_sign = 1};
  const RefineSummary landed = refined(near, {});
  EXPECT_TRUE(landed.converged) << landed.reason;
  EXPECT_NEAR(landed.flight.control_effort, 1 + near.error, 1e-8);
  const Proportional far = {.error = 1.1e-3 * length, .effort = 1, .model_sign = 1};
  const RefineSummary stayed = refined(far, {});
  EXPECT_FALSE(stayed.converged);
  EXPECT_EQ(stayed.reason, "no offset brings it nearer");
  EXPECT_EQ(stayed.flight.error.mean, stayed.error_before);
}

TEST(RefineExactly, LeavesACorrectionThatIsWithinTheTolerance) {
  const Proportional cloth = {.error = 0.5e-9 * length, .effort = 1};
  const RefineSummary summary = refined(cloth, {});
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(summary.rollouts, 1);
  EXPECT_EQ(summary.jacobians, 0);
}

TEST(RefineExactly, TransfersToACloneOfTheEngineWithoutAStep) {
  const Proportional cloth = {.error = 0.5, .effort = 0.4};
  const MakeBackend engine = engine_of(cloth);
  const RefineSummary answer = refined(cloth, {});
  const RefineSummary same = transfer(problem_of_cross(), answer, engine, engine);
  EXPECT_TRUE(same.converged);
  EXPECT_EQ(same.rollouts, answer.rollouts + 2);
  EXPECT_NEAR(same.error_before, 0.5, 1e-14);
  EXPECT_EQ(same.reference_correction, answer.reference_correction);
}

TEST(RefineExactly, TransfersToAnEngineThatArrivesElsewhere) {
  const Proportional cloth = {.error = 0.5, .effort = 0.4};
  const Proportional other = {.error = 0.5 + 0.01, .effort = 0.4};
  const RefineSummary answer = refined(cloth, {});
  const RefineSummary moved =
      transfer(problem_of_cross(), answer, engine_of(other), engine_of(cloth));
  EXPECT_TRUE(moved.converged) << moved.reason;
  EXPECT_LE(moved.flight.error.mean, 1e-5 * length);
  EXPECT_NEAR(moved.error_before, 0.51, 1e-14);
  // Under a limit it is flown and no more.
  const RefineSummary flown =
      transfer(problem_of_cross(), answer, engine_of(other), engine_of(cloth), {.effort_limit = 2});
  EXPECT_NEAR(flown.flight.error.mean, 0.01, 1e-8);
  EXPECT_EQ(flown.rollouts, answer.rollouts + 2);
}

TEST(TrackingGain, IsOfSeventeenRadiansUntilArrivalOrTheLargest) {
  Problem problem = problem_of_cross();
  problem.damping_ratio = 0.7;
  ScriptedBackend engine(problem, steps, [](const Moment&) { return cross(); });
  const double scale = problem.cloth().particle_mass;  // t₀ is 1 s
  EXPECT_DOUBLE_EQ(tracking_gain(engine), 300 * scale);
  engine.most_gain = 200 * scale;
  EXPECT_DOUBLE_EQ(tracking_gain(engine), 200 * scale);
}

}  // namespace
}  // namespace nuno
