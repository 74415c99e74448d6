#include <nuno/box2d.h>
#include <nuno/native.h>
#include <nuno/pareto_front.h>
#include <nuno/reference_motion.h>
#include <nuno/refine.h>
#include <nuno/scene_file.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "scene_library.h"

namespace nuno {
namespace {

/// A figure throw under the damped, moving reference.
Problem morph_problem(std::size_t which) {
  ChainScene scene = scene_library::figure_throws()[which];
  scene.reference = Reference::morph;
  scene.damping_ratio = 0.7;
  return make_problem(scene);
}

/// The same with the target's segments at the cloth's own lengths, so that it is within reach.
Problem reachable(Problem problem) {
  const Points drawn = problem.target;
  Points& target = problem.target;
  for (Index i = 0; i + 1 < target.cols(); ++i) {
    const Eigen::Vector2d direction = (drawn.col(i + 1) - drawn.col(i)).normalized();
    target.col(i + 1) = target.col(i) + problem.chain().rest_length[i] * direction;
  }
  target = shape_of(target).colwise() + centroid(drawn);
  return problem;
}

/// The library's scene at the gain of refining.
double tracking_gain_of(const Problem& problem) {
  return tracking_gain(*native::make_backend(problem));
}

/// One waved shape for each of correction_powers, none like another.
CorrectionDirections one_for_each_power(Index particles) {
  CorrectionDirections directions;
  directions.shapes.resize(2 * particles, static_cast<Index>(correction_powers.size()));
  for (std::size_t power = 0; power < correction_powers.size(); ++power) {
    const auto k = static_cast<Index>(power);
    directions.powers.push_back(k);
    for (Index i = 0; i < 2 * particles; ++i) {
      directions.shapes(i, k) = std::sin(0.3 * static_cast<double>((i + 1) * (k + 2)));
    }
  }
  return directions;
}

TEST(RolloutJacobian, IsTheDerivativeByCentralDifferences) {
  for (const Reference reference : {Reference::hold, Reference::morph}) {
    for (const Launch launch : {Launch::ballistic, Launch::inextensible}) {
      Problem problem = morph_problem(4);
      problem.reference = reference;
      problem.launch = launch;
      problem.reference_correction.assign(correction_powers.size(), Points::Zero(2, 32));
      const double gain = 0.3;
      const CorrectionDirections directions = one_for_each_power(32);
      const RolloutJacobian jacobian = native::make_backend(problem)->jacobian(gain, directions);
      for (std::size_t power = 0; power < correction_powers.size(); ++power) {
        const auto column = static_cast<Index>(power);
        const double d = 2e-6;
        Vector arrival = Vector::Zero(64);
        Vector forces = Vector::Zero(jacobian.forces.size());
        const std::pair<double, double> stencil[] = {{-2, 1}, {-1, -8}, {1, 8}, {2, -1}};
        for (const auto& [steps, weight] : stencil) {
          Problem aside = problem;
          aside.reference_correction[power] =
              steps * d * directions.shapes.col(column).reshaped(2, 32);
          const auto backend = native::make_backend(aside);
          arrival += weight * rollout(*backend, gain).final.reshaped() / (12 * d);
          forces += weight * backend->jacobian(gain, directions).forces / (12 * d);
        }
        // Fourth-order differences over micrometres: a launch that stretches shakes the cloth, and
        // larger ones show it; rounding 1e-14/1e-6.
        EXPECT_LT((jacobian.arrival.col(column) - arrival).norm(), 1e-6 * arrival.norm()) << power;
        EXPECT_LT((jacobian.forces_jacobian.col(column) - forces).norm(), 1e-6 * forces.norm())
            << power;
      }
    }
  }
}

TEST(RolloutJacobian, HasTheForcesOfTheControlEffort) {
  const Problem problem = morph_problem(4);
  const auto backend = native::make_backend(problem);
  const double gain = tracking_gain(*backend);
  const RolloutJacobian jacobian = backend->jacobian(gain, one_for_each_power(32));
  // Two dozen samples of a smooth flight.
  EXPECT_NEAR(jacobian.forces.norm(), rollout(*backend, gain).control_effort, 0.02);
}

TEST(Refine, ArrivesExactlyWhereTheTargetIsWithinReach) {
  for (const std::size_t which : {0u, 4u, 7u, 15u}) {
    const Problem problem = reachable(morph_problem(which));
    const RefineSummary summary =
        refine(problem, tracking_gain_of(problem), native::make_backend, native::make_backend);
    EXPECT_TRUE(summary.converged) << summary.reason;
    EXPECT_LT(summary.flight.error.mean, 1e-9 * problem.chain().size);
    EXPECT_GT(summary.error_before, 1e-4);
  }
}

TEST(Refine, ArrivesWithLessEffortThanAPlainFlightNeedsToComeNear) {
  for (const std::size_t which : {2u, 3u, 6u, 14u}) {  // M, N, W and S to 2
    const Problem problem = reachable(morph_problem(which));
    const auto backend = native::make_backend(problem);
    const RefineSummary summary =
        refine(problem, tracking_gain(*backend), native::make_backend, native::make_backend);
    EXPECT_TRUE(summary.converged) << summary.reason;
    // The plain control at 300 times as much gain is still a part in a thousand off.
    const Rollout plain = rollout(*backend, backend->largest_gain());
    EXPECT_GT(plain.error.mean, 1e-3 * problem.chain().size);
    EXPECT_LT(summary.flight.control_effort, 0.5 * plain.control_effort) << which;
  }
}

TEST(Refine, IsNearerWithMoreEffortAndKeepsItsLimit) {
  const Problem problem = reachable(morph_problem(3));
  const double gain = tracking_gain_of(problem);
  double last = std::numeric_limits<double>::infinity();
  for (const double limit : {0.4, 0.6, 0.9, 1.3}) {
    const RefineSummary summary =
        refine(problem, gain, native::make_backend, native::make_backend, {.effort_limit = limit});
    EXPECT_LE(summary.flight.control_effort, limit);
    EXPECT_GT(summary.flight.control_effort, 0.85 * limit);
    EXPECT_LT(summary.flight.error.mean, last) << limit;
    last = summary.flight.error.mean;
  }
}

TEST(Refine, LeavesAFlightThatForgetsHowItStarted) {
  const Problem problem = reachable(morph_problem(3));
  const double gain = tracking_gain_of(problem);
  Problem corrected = problem;
  const RefineSummary summary = refine(problem, gain, native::make_backend, native::make_backend);
  corrected.reference_correction = summary.reference_correction;
  const auto backend = native::make_backend(corrected);
  EXPECT_EQ(rollout(*backend, gain).final, summary.flight.final);  // the offset says it all
  EXPECT_LT(sensitivity(*backend, summary.flight), 0.1);
}

TEST(Refine, ComesNearerToATargetOutOfReach) {
  // Sharp corners: some of its segments are a third of the cloth's.
  const Problem problem =
      make_problem(std::get<ChainScene>(read_scene(NUNO_SCENES "/nuno/n1.json")));
  const RefineSummary summary =
      refine(problem, tracking_gain_of(problem), native::make_backend, native::make_backend);
  EXPECT_FALSE(summary.converged);
  EXPECT_LT(summary.flight.error.mean, 0.5 * summary.error_before);
  EXPECT_LT(summary.flight.max_strain, 0.05);  // and is not squeezed into it, which takes 0.5
}

TEST(Refine, SaysWhereItFindsNoFlightWithinItsLimit) {
  const Problem problem = morph_problem(14);  // S to 2
  const RefineSummary summary = refine(problem, tracking_gain_of(problem), native::make_backend,
                                       native::make_backend, {.effort_limit = 0.01});
  EXPECT_FALSE(summary.converged);
  EXPECT_EQ(summary.reason, "no flight of so little effort was found");
}

TEST(Refine, ImprovesThePapersControlToo) {
  Problem problem = reachable(morph_problem(4));
  problem.reference = Reference::hold;
  problem.damping_ratio = 0;
  const RefineSummary summary = refine(problem, 0.01, native::make_backend, native::make_backend);
  EXPECT_LT(summary.flight.error.mean, 0.1 * summary.error_before);
}

TEST(Refine, CarriesOverToTheOtherEngineAndIsCorrectedThere) {
  const Problem problem = reachable(morph_problem(2));
  const double length = problem.chain().size;
  const double gain = tracking_gain_of(problem);
  const RefineSummary answer = refine(problem, gain, native::make_backend, native::make_backend);
  Problem corrected = problem;
  corrected.reference_correction = answer.reference_correction;
  const double replayed = rollout(*box2d::make_backend(corrected), gain).error.mean;
  EXPECT_LT(replayed, 1e-2 * length);
  const RefineSummary transferred =
      transfer(problem, answer, box2d::make_backend, native::make_backend);
  EXPECT_TRUE(transferred.converged);
  EXPECT_LT(transferred.flight.error.mean, 0.3 * replayed);
  EXPECT_LE(transferred.rollouts, answer.rollouts + 7);
  EXPECT_EQ(transferred.error_before, rollout(*box2d::make_backend(problem), gain).error.mean);
  corrected.reference_correction = transferred.reference_correction;
  EXPECT_EQ(rollout(*box2d::make_backend(corrected), gain).final, transferred.flight.final);
}

TEST(Refine, IsOnlyFlownOnTheOtherEngineUnderAnEffortLimit) {
  const Problem problem = reachable(morph_problem(4));
  const double gain = tracking_gain_of(problem);
  const RefineOptions limited = {.effort_limit = 0.5};
  const RefineSummary answer =
      refine(problem, gain, native::make_backend, native::make_backend, limited);
  const RefineSummary transferred =
      transfer(problem, answer, box2d::make_backend, native::make_backend, limited);
  EXPECT_EQ(transferred.reference_correction, answer.reference_correction);
  EXPECT_EQ(transferred.rollouts, answer.rollouts + 2);
  EXPECT_NE(transferred.flight.final, answer.flight.final);
  EXPECT_FALSE(transferred.converged);
  EXPECT_NE(transferred.reason, "arrived within the tolerance");
}

TEST(Refine, LeavesTheCentroidWhereItWas) {
  const Problem problem = reachable(morph_problem(0));
  EXPECT_LT(refine(problem, 2, native::make_backend, native::make_backend).flight.error.centroid,
            1e-10);
}

TEST(ParetoFront, FallsInErrorAsItRisesInEffort) {
  const auto backend = native::make_backend(morph_problem(0));
  const std::vector<ParetoPoint> curve = pareto_front(*backend, 24);
  ASSERT_GT(curve.size(), 5u);
  EXPECT_EQ(curve.front().gain, 0);
  for (std::size_t i = 1; i < curve.size(); ++i) {
    EXPECT_LT(curve[i].error, curve[i - 1].error);
    EXPECT_GT(curve[i].effort, curve[i - 1].effort);
  }
}

TEST(ParetoFront, LeavesOutWhatIsBeatenInBothAndWhatDiverged) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<ParetoPoint> curve =
      pareto_optimal({{.gain = 0, .error = 5, .effort = 0},
                      {.gain = 1, .error = 3, .effort = 2},
                      {.gain = 2, .error = 4, .effort = 3},
                      {.gain = 3, .error = 3, .effort = 4},
                      {.gain = 4, .error = 2, .effort = 6},
                      {.gain = 5, .error = 1, .effort = 6},
                      {.gain = 6, .error = 4.5, .effort = 1},
                      {.gain = 7, .error = infinity, .effort = 0},
                      {.gain = 8, .error = 6, .effort = 0}});
  std::vector<double> gains;
  for (const ParetoPoint& point : curve) gains.push_back(point.gain);
  EXPECT_EQ(gains, (std::vector<double>{0, 6, 1, 5}));
}

TEST(ParetoFront, FindsTheLeastEffortWithinAnErrorLimit) {
  const auto backend = native::make_backend(morph_problem(0));
  const std::vector<ParetoPoint> curve = pareto_front(*backend, 24);
  const double limit = 0.01;
  const std::optional<ParetoPoint> point = least_effort(*backend, curve, limit);
  ASSERT_TRUE(point);
  EXPECT_LE(point->error, limit);
  EXPECT_NEAR(point->error, limit, 1e-6);  // no more effort than that takes
  EXPECT_EQ(rollout(*backend, point->gain).error.mean, point->error);
  EXPECT_FALSE(least_effort(*backend, curve, 1e-9));
}

TEST(ParetoFront, FindsTheLeastErrorWithinAnEffortLimit) {
  const auto backend = native::make_backend(morph_problem(0));
  const std::vector<ParetoPoint> curve = pareto_front(*backend, 24);
  const ParetoPoint point = least_error(*backend, curve, 0.2);
  EXPECT_LE(point.effort, 0.2);
  EXPECT_NEAR(point.effort, 0.2, 1e-6);
  EXPECT_EQ(least_error(*backend, curve, 1e9).gain, curve.back().gain);
  EXPECT_EQ(least_error(*backend, curve, 0).gain, 0);
}

TEST(ParetoFront, EndsWithWhatItsCallerThrows) {
  struct Enough {};
  const auto backend = native::make_backend(morph_problem(0));
  std::atomic<int> asked = 0;
  EXPECT_THROW(pareto_front(*backend, 24, {},
                            [&] {
                              if (++asked > 3) throw Enough();
                            }),
               Enough);
  // The three, and one more on every core.
  EXPECT_LE(asked, 3 + static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

}  // namespace
}  // namespace nuno
