// Rods that are joined freely: are they point masses that keep their distance, in rest and flight?

#include <nuno/box2d.h>
#include <nuno/launch.h>

#include <gtest/gtest.h>

#include "bare_problem.h"

#include <cmath>

namespace nuno {
namespace {

using Eigen::Vector2d;

// Box2D computes in single precision: 2⁻²⁴ = 6e-8 for each operation.
constexpr double single_rounding = 6e-8;

// ---- mass -------------------------------------------------------------------------------------

// Rods with each particle's mass halved between them are the point masses, whatever the lengths:
// across the chain, a force on one particle moves that particle and no other.
TEST(Box2dRods, APushAcrossAStraightChainMovesOneParticleAlone) {
  const Points straight{{0.0, 1.0, 1.5, 3.0, 3.2}, {0.0, 0.0, 0.0, 0.0, 0.0}};
  const auto backend = box2d::make_backend_with({.velocity_iterations = 100},
                                                with_time_step(problem_of(straight), 1e-3));
  const double mass = backend->problem().chain().particle_mass;
  const double force = 1e-3;
  const double speed = force / mass * backend->time_step() / 2;  // the first step: half a kick
  for (Index pushed = 0; pushed < 5; ++pushed) {
    const auto chain = backend->start(backend->problem().chain().initial, Points::Zero(2, 5));
    Points forces = Points::Zero(2, 5);
    forces(1, pushed) = force;
    chain->step(forces);
    Points expected = Points::Zero(2, 5);
    expected(1, pushed) = speed;
    // A few roundings of rods that spin several times as fast as the particle moves.
    EXPECT_LT((chain->velocities() - expected).cwiseAbs().maxCoeff(), 100 * single_rounding * speed)
        << "particle " << pushed;
  }
}

TEST(Box2dRods, APullAlongAStraightChainMovesAllParticlesAlike) {
  const Points straight{{0.0, 1.0, 1.5, 3.0, 3.2}, {0.0, 0.0, 0.0, 0.0, 0.0}};
  const auto backend = box2d::make_backend_with({.velocity_iterations = 200},
                                                with_time_step(problem_of(straight), 1e-3));
  const auto chain = backend->start(backend->problem().chain().initial, Points::Zero(2, 5));
  Points forces = Points::Zero(2, 5);
  forces(0, 4) = 1e-3;
  chain->step(forces);
  const double speed = 1e-3 / 0.1 * backend->time_step() / 2;
  // Gauss–Seidel over four joints gains a digit in six sweeps: 200 are done to the last bit.
  EXPECT_LT((chain->velocities().row(0).array() - speed).abs().maxCoeff(),
            100 * single_rounding * speed);
  EXPECT_LT(chain->velocities().row(1).cwiseAbs().maxCoeff(), 100 * single_rounding * speed);
}

TEST(Box2dRods, AnyForcesOnABentChainActAsOnPointMassesThatKeepTheirDistance) {
  const Points shape{{0.0, 1.0, 1.3, 0.9, 1.9}, {0.0, 0.2, 1.1, 1.5, 2.0}};
  const Points forces{{1.0, -2.0, 0.5, 3.0, -1.0}, {0.3, 1.0, -2.0, 0.7, 0.2}};
  const auto backend = box2d::make_backend_with({.velocity_iterations = 200},
                                                with_time_step(problem_of(shape), 1e-5));
  const auto chain = backend->start(backend->problem().chain().initial, Points::Zero(2, 5));
  chain->step(forces);
  const Points expected = without_stretching(shape, forces) /
                          backend->problem().chain().particle_mass * (backend->time_step() / 2);
  EXPECT_LT((chain->velocities() - expected).cwiseAbs().maxCoeff(),
            100 * single_rounding * expected.cwiseAbs().maxCoeff());
}

TEST(Box2dRods, ALaunchThatStretchesLosesOnlyItsStretching) {
  const Points shape{{0.0, 1.0, 1.3, 0.9, 1.9}, {0.0, 0.2, 1.1, 1.5, 2.0}};
  const Points launch{{1.0, -2.0, 0.5, 3.0, -1.0}, {0.3, 1.0, -2.0, 0.7, 0.2}};
  const auto backend = box2d::make_backend(with_time_step(problem_of(shape), 1e-6));
  const auto chain = backend->start(backend->problem().chain().initial, launch);
  EXPECT_EQ(chain->velocities(), launch);
  chain->step(Points::Zero(2, 5));
  // The rods turn by 1e-5 rad within the step.
  EXPECT_LT((chain->velocities() - without_stretching(shape, launch)).cwiseAbs().maxCoeff(), 1e-4);
}

// ---- flight -----------------------------------------------------------------------------------

TEST(Box2dFlight, AFreeClothFollowsTheDragRecurrenceStepByStep) {
  Problem problem = problem_of(Points{{0.0, 0.3, 0.5, 0.6}, {0.0, 0.1, 0.4, 0.8}}, 9.8,
                               {.air_drag = 0.3, .hinge_stiffness = 0});
  const auto backend = box2d::make_backend(problem);
  const DragRecurrence r = backend->drag_recurrence();
  const Vector2d launch(30, 12);
  const auto chain = backend->start(backend->problem().chain().initial, launch.replicate(1, 4));
  Vector2d x(0, 0), v = launch;
  for (Index n = 0; n < backend->steps(); ++n) {
    chain->step(Points::Zero(2, 4));
    v = (n == 0 ? r.r1 : r.r) * v - Vector2d(0, (n == 0 ? r.q1 : r.q) * 9.8);
    x += r.h * v;
    // The mass centre flies in double precision, 32 m far; the shape about it is Box2D's.
    const Points moved = chain->positions() - problem.chain().initial;
    ASSERT_LT((centroid(moved) - x).norm(), 1e-12) << "step " << n;
    ASSERT_LT((moved.colwise() - x).cwiseAbs().maxCoeff(), 2e-6) << "step " << n;
  }
}

TEST(Box2dFlight, ForcesMoveTheMassCentreByTheirMeanWhateverTheirSpread) {
  const Points shape{{0.0, 0.3, 0.5, 0.6}, {0.0, 0.1, 0.4, 0.8}};
  const auto backend = box2d::make_backend(
      with_time_step(problem_of(shape, 9.8, {.air_drag = 0.3, .hinge_stiffness = 0}), 1e-3));
  const DragRecurrence r = backend->drag_recurrence();
  const double mass = backend->cloth().particle_mass;
  const auto chain = backend->start(shape, Points::Zero(2, 4));
  Vector2d x = centroid(shape), v(0, 0);
  for (Index n = 0; n < 300; ++n) {
    Points forces{{0.3, -0.1, 0.2, 0.0}, {0.1, 0.4, -0.2, 0.1}};
    forces *= std::cos(0.01 * static_cast<double>(n));
    chain->step(forces);
    const Vector2d acceleration = centroid(forces) / mass - Vector2d(0, 9.8);
    v = (n == 0 ? r.r1 : r.r) * v + (n == 0 ? r.q1 : r.q) * acceleration;
    x += r.h * v;
    ASSERT_LT((centroid(chain->positions()) - x).norm(), 1e-12) << "step " << n;
    ASSERT_LT((centroid(chain->velocities()) - v).norm(), 1e-12) << "step " << n;
  }
}

TEST(Box2dFlight, DragAndGravityAreExactAtAnyStep) {
  const Problem problem = problem_of(bent(1), 9.8, {.air_drag = 0.3, .hinge_stiffness = 0});
  const double rate = problem.chain().drag_rate;
  for (const double h : {1e-2, 1e-3, 1e-4}) {
    const auto backend = box2d::make_backend(with_time_step(problem, h));
    const DragRecurrence r = backend->drag_recurrence();
    EXPECT_NEAR(r.r, std::exp(-rate * r.h), 1e-15);
    EXPECT_NEAR(r.q, -std::expm1(-rate * r.h) / rate, 1e-15);
  }
}

TEST(Box2dFlight, VelocitiesAreTheMeanOverTheLastStep) {
  const Points shape{{0.0, 1.0, 1.3, 0.9, 1.9}, {0.0, 0.2, 1.1, 1.5, 2.0}};
  const Points launch{{1.0, -2.0, 0.5, 3.0, -1.0}, {0.3, 1.0, -2.0, 0.7, 0.2}};
  const auto backend = box2d::make_backend(with_time_step(problem_of(shape), 1e-3));
  const auto chain = backend->start(backend->problem().chain().initial, launch);
  for (int n = 0; n < 100; ++n) {
    const Points before = chain->positions();
    chain->step(Points::Zero(2, 5));
    const Points mean = (chain->positions() - before) / backend->time_step();
    // The first steps close the joints to second order only; later, rounding of positions over h.
    const double tolerance = n < 5 ? 2e-2 : 2e-3;
    ASSERT_LT((mean - chain->velocities()).cwiseAbs().maxCoeff(), tolerance) << "step " << n;
  }
}

TEST(Box2dFlight, SegmentsKeepTheirLength) {
  const Points shape{{0.0, 1.0, 1.3, 0.9, 1.9}, {0.0, 0.2, 1.1, 1.5, 2.0}};
  const Points launch{{1.0, -2.0, 0.5, 3.0, -1.0}, {0.3, 1.0, -2.0, 0.7, 0.2}};
  const auto backend = box2d::make_backend(with_time_step(problem_of(shape), 1e-3));
  const auto chain = backend->start(backend->problem().chain().initial, launch);
  double worst = 0;
  for (Index n = 0; n < backend->steps(); ++n) {
    chain->step(Points::Zero(2, 5));
    const Vector strain =
        segment_lengths(chain->positions()).cwiseQuotient(backend->problem().chain().rest_length);
    worst = std::max(worst, (strain.array() - 1).abs().maxCoeff());
  }
  // Rods turn by up to 5e-3 rad per step: half the square of it, 1e-5, at the first step, which
  // starts without the impulses of one before.
  EXPECT_LT(worst, 1e-5);
}

// With 16 sweeps, which do not solve 30 joints to the last digit.
TEST(Box2dFlight, ALongLivelyChainStaysTogetherAndKeepsItsEnergy) {
  Points shape(2, 32), launch(2, 32);
  for (Index i = 0; i < 32; ++i) {
    const double s = static_cast<double>(i) / 31;
    shape.col(i) = Vector2d(std::sin(3 * s), 1 - std::cos(3 * s)) / 3;
    launch.col(i) = Vector2d(2 * std::cos(5 * s), 2 * std::sin(7 * s));
  }
  const auto backend = box2d::make_backend_with({.velocity_iterations = 16},
                                                with_time_step(problem_of(shape), 1.0 / 2000));
  const auto chain = backend->start(shape, launch);
  double first = 0;
  for (Index n = 0; n < backend->steps(); ++n) {
    chain->step(Points::Zero(2, 32));
    if (n == 10) first = chain->velocities().squaredNorm();
  }
  const Vector ratio =
      segment_lengths(chain->positions()).cwiseQuotient(backend->problem().chain().rest_length);
  // 6e-5, and 3e-4 without the position solver's corrections.
  EXPECT_LT((ratio.array() - 1).abs().maxCoeff(), 1.5e-4);
  // 4e-6; Box2D's own step loses 6 %, a weight w of 0.1 loses 5e-4.
  EXPECT_NEAR(chain->velocities().squaredNorm(), first, 1e-4 * first);
}

// RATTLE's order: Box2D's own step would halve it.
TEST(Box2dFlight, HalfTheStepLeavesAQuarterOfTheError) {
  const Points shape{{0.0, 1.0, 1.3, 0.9, 1.9}, {0.0, 0.2, 1.1, 1.5, 2.0}};
  const Points launch{{1.0, -2.0, 0.5, 3.0, -1.0}, {0.3, 1.0, -2.0, 0.7, 0.2}};
  Problem problem = problem_of(shape, 0, {.air_drag = 0.1, .hinge_stiffness = 0.02});
  const auto arrive = [&](double h) {
    const auto backend =
        box2d::make_backend_with({.velocity_iterations = 60}, with_time_step(problem, h));
    const auto chain = backend->start(backend->problem().chain().initial, launch);
    for (Index n = 0; n < backend->steps(); ++n) chain->step(Points::Zero(2, 5));
    return chain->positions();
  };
  const Points coarse = arrive(1.0 / 100), middle = arrive(1.0 / 200), fine = arrive(1.0 / 400);
  const double ratio = (coarse - middle).norm() / (middle - fine).norm();
  // 4 in the limit, 2 for a method of first order. Rounding adds up to 1e-5.
  EXPECT_GT((middle - fine).norm(), 5e-5);
  EXPECT_GT(ratio, 3);
  EXPECT_LT(ratio, 5);
}

TEST(Box2dFlight, ASwingingChainKeepsItsEnergy) {
  const Points shape{{0.0, 1.0, 1.3, 0.9, 1.9}, {0.0, 0.2, 1.1, 1.5, 2.0}};
  const Points launch{{1.0, -2.0, 0.5, 3.0, -1.0}, {0.3, 1.0, -2.0, 0.7, 0.2}};
  const auto backend = box2d::make_backend_with({.velocity_iterations = 60},
                                                with_time_step(problem_of(shape), 1e-3));
  const auto chain = backend->start(backend->problem().chain().initial, launch);
  for (int n = 0; n < 10; ++n) chain->step(Points::Zero(2, 5));
  const double first = chain->velocities().squaredNorm();
  for (Index n = 10; n < backend->steps(); ++n) chain->step(Points::Zero(2, 5));
  EXPECT_NEAR(chain->velocities().squaredNorm(), first, 1e-3 * first);
}

}  // namespace
}  // namespace nuno
