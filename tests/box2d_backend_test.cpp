// The Box2D engine alone: is the machine of rods, joints and springs the chain that it stands for?

#include <nuno/box2d.h>
#include <nuno/launch.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace nuno {
namespace {

using box2d::Hinge;
using Eigen::Vector2d;
using std::numbers::pi;

// Box2D computes in single precision: 2⁻²⁴ = 6e-8 for each operation.
constexpr double single_rounding = 6e-8;

/// A problem with exactly these particles; nothing pulls or brakes it unless `cloth` says so.
Problem problem_of(const Points& positions, double gravity = 0,
                   const Cloth& cloth = {.air_drag = 0, .hinge_stiffness = 0}) {
  const Index n = positions.cols();
  Problem problem;
  problem.chain.initial = positions;
  problem.chain.rest_length = segment_lengths(positions);
  problem.chain.hinge_length =
      0.5 * (problem.chain.rest_length.head(n - 2) + problem.chain.rest_length.tail(n - 2));
  problem.chain.length = problem.chain.rest_length.sum();
  problem.chain.particle_mass = cloth.mass / static_cast<double>(n);
  problem.chain.particle_drag = cloth.air_drag / static_cast<double>(n);
  problem.chain.gravity = gravity;
  problem.chain.cloth = cloth;
  problem.target = positions;
  problem.arrival_time = 1;
  return problem;
}

/// Three particles around a hinge that turns by `angle`, on segments of these lengths.
Points bent(double angle, double before = 0.5, double after = 0.3) {
  return Points{{-before, 0, after * std::cos(angle)}, {0, 0, after * std::sin(angle)}};
}

double hinge_angle(const Points& x) {
  const Vector2d a = x.col(1) - x.col(0), b = x.col(2) - x.col(1);
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

/// −∂θ/∂x for three particles: the forces of a unit moment that straightens them.
Points straightening_forces(const Points& x) {
  const auto perpendicular = [](const Vector2d& v) {
    return Vector2d(Vector2d(-v.y(), v.x()) / v.squaredNorm());
  };
  Points forces(2, 3);
  forces.col(0) = -perpendicular(x.col(1) - x.col(0));
  forces.col(2) = -perpendicular(x.col(2) - x.col(1));
  forces.col(1) = -forces.col(0) - forces.col(2);
  return forces;
}

/// The moment that a lone hinge of this cloth has: from the velocities that it gives to three free
/// particles within one step, which takes half a kick. What the particles of an inextensible chain
/// do under a unit moment is the part of its forces that stretches nothing.
double measured_moment(const Points& shape, const Points& velocities, const Cloth& cloth,
                       Hinge form) {
  const auto backend = box2d::make_backend(
      problem_of(shape, 0, cloth), {.time_step = 1e-5, .hinge = form, .velocity_iterations = 200});
  const auto chain = backend->start(backend->problem().chain.initial, velocities);
  chain->step(Points::Zero(2, 3));
  const double mass = backend->problem().chain.particle_mass;
  const Points response = without_stretching(shape, straightening_forces(shape)) / mass;
  const Points gained = chain->velocities() - velocities;
  return gained.cwiseProduct(response).sum() / response.squaredNorm() / (backend->time_step() / 2);
}

// ---- mass -------------------------------------------------------------------------------------

// Rods with each particle's mass halved between them are the point masses, whatever the lengths:
// across the chain, a force on one particle moves that particle and no other.
TEST(Box2dRods, APushAcrossAStraightChainMovesOneParticleAlone) {
  const Points straight{{0.0, 1.0, 1.5, 3.0, 3.2}, {0.0, 0.0, 0.0, 0.0, 0.0}};
  const auto backend =
      box2d::make_backend(problem_of(straight), {.time_step = 1e-3, .velocity_iterations = 100});
  const double mass = backend->problem().chain.particle_mass;
  const double force = 1e-3;
  const double speed = force / mass * backend->time_step() / 2;  // the first step: half a kick
  for (Index pushed = 0; pushed < 5; ++pushed) {
    const auto chain = backend->start(backend->problem().chain.initial, Points::Zero(2, 5));
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
  const auto backend =
      box2d::make_backend(problem_of(straight), {.time_step = 1e-3, .velocity_iterations = 200});
  const auto chain = backend->start(backend->problem().chain.initial, Points::Zero(2, 5));
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
  const auto backend =
      box2d::make_backend(problem_of(shape), {.time_step = 1e-5, .velocity_iterations = 200});
  const auto chain = backend->start(backend->problem().chain.initial, Points::Zero(2, 5));
  chain->step(forces);
  const Points expected = without_stretching(shape, forces) /
                          backend->problem().chain.particle_mass * (backend->time_step() / 2);
  EXPECT_LT((chain->velocities() - expected).cwiseAbs().maxCoeff(),
            100 * single_rounding * expected.cwiseAbs().maxCoeff());
}

TEST(Box2dRods, ALaunchThatStretchesLosesOnlyItsStretching) {
  const Points shape{{0.0, 1.0, 1.3, 0.9, 1.9}, {0.0, 0.2, 1.1, 1.5, 2.0}};
  const Points launch{{1.0, -2.0, 0.5, 3.0, -1.0}, {0.3, 1.0, -2.0, 0.7, 0.2}};
  const auto backend = box2d::make_backend(problem_of(shape), {.time_step = 1e-6});
  const auto chain = backend->start(backend->problem().chain.initial, launch);
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
  const auto chain = backend->start(backend->problem().chain.initial, launch.replicate(1, 4));
  Vector2d x(0, 0), v = launch;
  for (Index n = 0; n < backend->steps(); ++n) {
    chain->step(Points::Zero(2, 4));
    v = (n == 0 ? r.r1 : r.r) * v - Vector2d(0, (n == 0 ? r.q1 : r.q) * 9.8);
    x += r.h * v;
    // Box2D rounds each kick of gravity, 2e-6 rods per step, to the last digit of a velocity of
    // 0.04: 1e-3 of it at worst and mostly the same way, so up to 1e-3 of the fall g·t²/2.
    const double t = static_cast<double>(n + 1) * r.h;
    const Points moved = chain->positions() - problem.chain.initial;
    ASSERT_LT((moved.colwise() - x).cwiseAbs().maxCoeff(), 2e-6 + 1e-3 * 4.9 * t * t)
        << "step " << n;
  }
}

// Nothing but Box2D's own motion may bring the centroid down: it has no other way to know.
TEST(Box2dFlight, AClothDroppedFromRestFallsByGravity) {
  const Problem problem = problem_of(Points{{0.0, 0.3, 0.5, 0.6}, {0.0, 0.1, 0.4, 0.8}}, 9.8);
  const auto backend = box2d::make_backend(problem);
  const auto chain = backend->start(problem.chain.initial, Points::Zero(2, 4));
  for (Index n = 0; n < backend->steps(); ++n) chain->step(Points::Zero(2, 4));
  const Vector2d fall = centroid(chain->positions()) - centroid(problem.chain.initial);
  EXPECT_NEAR(fall.y(), -4.9, 1e-3 * 4.9);  // rounding as above; no drag, so no other error
  EXPECT_NEAR(fall.x(), 0, 1e-5);
}

TEST(Box2dFlight, DragAndGravityAreExactAtAnyStep) {
  const Problem problem = problem_of(bent(1), 9.8, {.air_drag = 0.3, .hinge_stiffness = 0});
  const double rate = problem.chain.drag_rate();
  for (const double h : {1e-2, 1e-3, 1e-4}) {
    const auto backend = box2d::make_backend(problem, {.time_step = h});
    const DragRecurrence r = backend->drag_recurrence();
    EXPECT_NEAR(r.r, std::exp(-rate * r.h), 1e-15);
    EXPECT_NEAR(r.q, -std::expm1(-rate * r.h) / rate, 1e-15);
  }
}

TEST(Box2dFlight, VelocitiesAreTheMeanOverTheLastStep) {
  const Points shape{{0.0, 1.0, 1.3, 0.9, 1.9}, {0.0, 0.2, 1.1, 1.5, 2.0}};
  const Points launch{{1.0, -2.0, 0.5, 3.0, -1.0}, {0.3, 1.0, -2.0, 0.7, 0.2}};
  const auto backend = box2d::make_backend(problem_of(shape), {.time_step = 1e-3});
  const auto chain = backend->start(backend->problem().chain.initial, launch);
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
  const auto backend = box2d::make_backend(problem_of(shape), {.time_step = 1e-3});
  const auto chain = backend->start(backend->problem().chain.initial, launch);
  double worst = 0;
  for (Index n = 0; n < backend->steps(); ++n) {
    chain->step(Points::Zero(2, 5));
    const Vector strain =
        segment_lengths(chain->positions()).cwiseQuotient(backend->problem().chain.rest_length);
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
  const auto backend =
      box2d::make_backend(problem_of(shape), {.time_step = 1.0 / 2000, .velocity_iterations = 16});
  const auto chain = backend->start(shape, launch);
  double first = 0;
  for (Index n = 0; n < backend->steps(); ++n) {
    chain->step(Points::Zero(2, 32));
    if (n == 10) first = chain->velocities().squaredNorm();
  }
  const Vector ratio =
      segment_lengths(chain->positions()).cwiseQuotient(backend->problem().chain.rest_length);
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
    const auto backend = box2d::make_backend(problem, {.time_step = h, .velocity_iterations = 60});
    const auto chain = backend->start(backend->problem().chain.initial, launch);
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
  const auto backend =
      box2d::make_backend(problem_of(shape), {.time_step = 1e-3, .velocity_iterations = 60});
  const auto chain = backend->start(backend->problem().chain.initial, launch);
  for (int n = 0; n < 10; ++n) chain->step(Points::Zero(2, 5));
  const double first = chain->velocities().squaredNorm();
  for (Index n = 10; n < backend->steps(); ++n) chain->step(Points::Zero(2, 5));
  EXPECT_NEAR(chain->velocities().squaredNorm(), first, 1e-3 * first);
}

// ---- hinges -----------------------------------------------------------------------------------

TEST(Box2dHinge, TheWeldHasTheMomentOfItsLawUpTo2AndAHalfRadians) {
  const Cloth cloth = {.air_drag = 0, .hinge_stiffness = 0.01};
  for (const double angle : {-2.5, -1.0, 0.01, 0.3, 1.0, 1.7, 2.0, 2.5}) {
    const double law = cloth.hinge_stiffness * angle / 0.4;
    const double moment = measured_moment(bent(angle), Points::Zero(2, 3), cloth, Hinge::soft_weld);
    // Single precision of the difference of two rods' angles, 2e-7 rad.
    EXPECT_NEAR(moment, law, 1e-4 * std::abs(law)) << angle;
  }
}

TEST(Box2dHinge, TheSpringPairHasTheMomentOfItsGeometryToTheEndOfItsRange) {
  const Cloth cloth = {.air_drag = 0, .hinge_stiffness = 0.01};
  for (const double angle : {-1.69, -1.0, 0.1, 0.3, 1.0, 1.5, 1.69}) {
    const double phi = angle / 2;
    const double law = cloth.hinge_stiffness * angle / 0.4;
    const double geometry = cloth.hinge_stiffness / 0.4 * 2 * std::sin(phi) *
                            (4.0 / 3 * (1 - std::cos(phi)) + std::cos(phi));
    const double moment =
        measured_moment(bent(angle), Points::Zero(2, 3), cloth, Hinge::spring_pair);
    // Single precision of the springs' lengths, 1e-7 of up to 0.01 that they are stretched.
    EXPECT_NEAR(moment, geometry, 3e-4 * std::abs(law)) << angle;
    EXPECT_NEAR(moment, law, 0.02 * std::abs(law)) << angle;  // what the header promises
  }
}

TEST(Box2dHinge, ADashpotBrakesTheTurning) {
  const Cloth cloth = {.air_drag = 0, .hinge_stiffness = 0, .hinge_damping = 1e-2};
  for (const double angle : {0.0, 1.0, -1.5}) {
    const Points shape = bent(angle);
    const Points turning = without_stretching(shape, -straightening_forces(shape)) * 0.005;
    const double rate = -straightening_forces(shape).cwiseProduct(turning).sum();
    const double law = cloth.hinge_damping * rate / 0.4;
    // Over half a kick the dashpot itself slows the turning by 7e-4, and the rods' own turning
    // takes the velocities with it by 1e-3 of what is gained.
    EXPECT_NEAR(measured_moment(shape, turning, cloth, Hinge::soft_weld), law, 3e-3 * law) << angle;
    const double phi = angle / 2;
    const double pair = law * (1 + std::sin(phi) * std::sin(phi) / 3);
    EXPECT_NEAR(measured_moment(shape, turning, cloth, Hinge::spring_pair), pair, 3e-3 * law)
        << angle;
  }
}

TEST(Box2dHinge, ASmallBendingSwingsAtItsFrequency) {
  // Three particles in the motion (1, −2, 1)·s: θ = 6s/ℓ, energies ½·6m·ṡ² and ½·k·36s²/ℓ².
  const double length = 0.5;
  const Cloth cloth = {.air_drag = 0, .hinge_stiffness = 1e-3};
  Problem problem = problem_of(bent(0.02, length, length), 0, cloth);
  const double stiffness = cloth.hinge_stiffness / length;
  const double frequency =
      std::sqrt(stiffness * 6 / (problem.chain.particle_mass * length * length));
  problem.arrival_time = 10 * 2 * pi / frequency;
  for (const Hinge form : {Hinge::soft_weld, Hinge::spring_pair}) {
    const auto backend =
        box2d::make_backend(problem, {.time_step = 0.02 / frequency, .hinge = form});
    const auto chain = backend->start(backend->problem().chain.initial, Points::Zero(2, 3));
    double crossings = 0, before = 0.02, last = 0;
    for (Index n = 0; n < backend->steps(); ++n) {
      chain->step(Points::Zero(2, 3));
      const double now = hinge_angle(chain->positions());
      const double time = static_cast<double>(n) * backend->time_step();
      if ((now < 0) != (before < 0)) {
        last = time + backend->time_step() * before / (before - now);
        ++crossings;
      }
      before = now;
    }
    ASSERT_EQ(crossings, 20);
    // The leapfrog's (ωh)²/24 = 2e-5, the amplitude's θ² = 4e-4, and 2e-7 rad of 0.02.
    EXPECT_NEAR((crossings - 0.5) * pi / last, frequency, 1e-3 * frequency);
    EXPECT_NEAR(before, 0.02, 0.03 * 0.02);  // nothing damps it
  }
}

TEST(Box2dHinge, AHingeThatTurnsThroughHalfATurnIsPulledOnTheOtherWay) {
  const Cloth cloth = {.air_drag = 0, .hinge_stiffness = 0.01};
  const Points shape = bent(3.1, 0.5, 0.5);
  const Points turning = without_stretching(shape, -straightening_forces(shape)) * 0.5;
  const auto backend = box2d::make_backend(problem_of(shape, 0, cloth), {.time_step = 1e-4});
  const auto chain = backend->start(backend->problem().chain.initial, turning);
  const auto rate = [&] {
    return -straightening_forces(chain->positions()).cwiseProduct(chain->velocities()).sum();
  };
  while (hinge_angle(chain->positions()) > 0) chain->step(Points::Zero(2, 3));
  const double across = rate();
  for (int n = 0; n < 100; ++n) chain->step(Points::Zero(2, 3));
  EXPECT_LT(hinge_angle(chain->positions()), -2);
  EXPECT_GT(rate(), across);
}

TEST(Box2dHinge, TheWeldSurvivesASharpFold) {
  const auto backend = box2d::make_backend(
      problem_of(bent(179 * pi / 180, 0.5, 0.5), 9.8, {.air_drag = 0.05, .hinge_stiffness = 0.01}));
  const Rollout flight = rollout(*backend, 0.01);
  EXPECT_EQ(flight.status, RolloutStatus::ok);
}

TEST(Box2dHinge, TheSpringPairRefusesAShapeBeyondItsRange) {
  const Problem problem = problem_of(bent(1.75));
  EXPECT_NO_THROW(box2d::make_backend(problem, {.time_step = {}, .hinge = Hinge::soft_weld}));
  try {
    box2d::make_backend(problem, {.time_step = {}, .hinge = Hinge::spring_pair});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "/initial: a turning angle of 1.75 rad at particle 1 is not <= 1.7, the range of "
                 "the spring pair on box2d");
  }
}

TEST(Box2dHinge, AFlightThatLeavesTheSpringPairsRangeHasDiverged) {
  const Points shape = bent(1.6, 0.5, 0.5);
  const Points turning = without_stretching(shape, -straightening_forces(shape)) * 0.5;
  for (const Hinge form : {Hinge::soft_weld, Hinge::spring_pair}) {
    const auto backend = box2d::make_backend(problem_of(shape), {.time_step = {}, .hinge = form});
    const auto chain = backend->start(backend->problem().chain.initial, turning);
    while (chain->positions().allFinite() && hinge_angle(chain->positions()) < 1.8) {
      chain->step(Points::Zero(2, 3));
    }
    EXPECT_EQ(chain->positions().allFinite(), form == Hinge::soft_weld);
    EXPECT_EQ(chain->failure(), form == Hinge::soft_weld
                                    ? ""
                                    : "a hinge turns further than its pair of springs reaches");
  }
}

// ---- limits: no input may end in one of Box2D's assertions ------------------------------------

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Box2dLimits, ABadForceEndsTheFlightForGood) {
  const auto backend = box2d::make_backend(problem_of(bent(1)));
  for (const double bad : {nan, infinity, -infinity, 1e300, 1e38, 1e30}) {
    for (Index place = 0; place < 6; ++place) {
      const auto chain = backend->start(backend->problem().chain.initial, Points::Zero(2, 3));
      chain->step(Points::Zero(2, 3));
      Points forces = Points::Zero(2, 3);
      forces(place) = bad;
      chain->step(forces);
      EXPECT_TRUE(chain->positions().array().isNaN().all()) << bad;
      EXPECT_EQ(chain->failure(), "a force is larger than Box2D can take in one step");
      chain->step(Points::Zero(2, 3));  // nothing wakes it
      EXPECT_TRUE(chain->positions().array().isNaN().all()) << bad;
    }
  }
}

TEST(Box2dLimits, ABadLaunchNeverReachesBox2d) {
  const auto backend = box2d::make_backend(problem_of(bent(1)));
  for (const double bad : {nan, infinity, -infinity, 1e300, 1e38, 1e6}) {
    Points launch = Points::Zero(2, 3);
    launch(1, 1) = bad;
    const auto chain = backend->start(backend->problem().chain.initial, launch);
    chain->step(Points::Zero(2, 3));
    EXPECT_TRUE(chain->positions().array().isNaN().all()) << bad;
    EXPECT_TRUE(chain->failure().starts_with("a rod is launched faster than Box2D moves it"));
  }
}

TEST(Box2dLimits, AMotionThatBox2dWouldClampHasDiverged) {
  const auto backend = box2d::make_backend(problem_of(bent(1)), {.time_step = 1e-3});
  const auto speed = [&](double rods_per_step) {
    return rods_per_step * 0.4 / backend->time_step();
  };
  const Points none = Points::Zero(2, 3);
  const auto allowed =
      backend->start(backend->problem().chain.initial, Vector2d(speed(1.85), 0).replicate(1, 3));
  const auto clamped =
      backend->start(backend->problem().chain.initial, Vector2d(speed(1.95), 0).replicate(1, 3));
  allowed->step(none);
  clamped->step(none);
  EXPECT_TRUE(allowed->positions().allFinite());
  EXPECT_TRUE(clamped->positions().array().isNaN().all());
  // Pushed over the limit later: the step that passes it is the last.
  Points forces = Points::Zero(2, 3);
  forces.row(0).setConstant(0.1 / 3 * speed(0.1) / backend->time_step());
  EXPECT_EQ(allowed->failure(), "");
  allowed->step(forces);
  EXPECT_TRUE(allowed->positions().array().isNaN().all());
  EXPECT_TRUE(allowed->failure().starts_with("a rod gets faster than Box2D moves it"));
}

TEST(Box2dLimits, ExtremeScenesAreRefusedOrFlyOrDivergeButNeverAbort) {
  Scene plain;
  plain.arrival_time = 1;
  plain.particles = 5;
  plain.initial = Points{{0.0, 1.0, 1.5}, {0.0, 0.0, 0.5}};
  plain.target = Points{{3.0, 3.5}, {1.0, 2.0}};
  const std::vector<void (*)(Scene&, double)> changes = {
      [](Scene& s, double x) { s.arrival_time = x; },
      [](Scene& s, double x) { s.gravity = x; },
      [](Scene& s, double x) { s.cloth.mass = x; },
      [](Scene& s, double x) { s.cloth.air_drag = x; },
      [](Scene& s, double x) { s.cloth.hinge_stiffness = x; },
      [](Scene& s, double x) { s.cloth.hinge_damping = x; },
      [](Scene& s, double x) { s.initial *= x; },
      [](Scene& s, double x) { s.target *= x; },
      [](Scene& s, double x) { s.initial *= x, s.target *= x; },
  };
  for (const auto& change : changes) {
    for (const double value : {1e-300, 1e-160, 1e-80, 1e-30, 1e-8, 1e8, 1e30, 1e80, 1e160, 1e300}) {
      for (const Hinge form : {Hinge::soft_weld, Hinge::spring_pair}) {
        Scene scene = plain;
        change(scene, value);
        try {
          const Problem problem = make_problem(scene);
          const auto backend = box2d::make_backend(problem, {.time_step = {}, .hinge = form});
          EXPECT_GT(backend->steps(), 0);
          const auto chain = backend->start(
              backend->problem().chain.initial,
              ballistic_launch(problem.chain.initial, problem.target, problem.arrival_time,
                               problem.chain.gravity, problem.chain.drag_rate()));
          for (int n = 0; n < 20; ++n) {
            chain->step(Points::Constant(2, 5, problem.chain.particle_mass));
          }
          EXPECT_TRUE(chain->positions().allFinite() || chain->positions().array().isNaN().all());
        } catch (const InputError& error) {
          EXPECT_EQ(std::string(error.what()).find("nan"), std::string::npos) << error.what();
        }
      }
    }
  }
}

TEST(Box2dLimits, AWishForTooManyStepsIsRefusedByName) {
  const auto complaint = [](double wish) -> std::string {
    try {
      box2d::make_backend(problem_of(bent(1)), {.time_step = wish});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(1e-9),
            "/time_step: 1e-09 takes 1e+09 steps on box2d, which is not <= 50000000");
  EXPECT_EQ(complaint(0), "/time_step: 0 is not > 0");
  EXPECT_EQ(complaint(nan), "/time_step: nan is not > 0");
  EXPECT_EQ(complaint(1e-7), "");
}

TEST(Box2dLimits, AWishForTooLongAStepIsCutToWhatTheClothNeeds) {
  const Cloth stiff = {.air_drag = 0, .hinge_stiffness = 1};
  const auto backend = box2d::make_backend(problem_of(bent(0.1), 0, stiff), {.time_step = 1});
  const double per_hinge = 16 / (0.4 * 0.3 * 0.3 * backend->problem().chain.particle_mass);
  EXPECT_LE(per_hinge * std::pow(backend->time_step(), 2), 0.5);
  const Rollout flight = rollout(*backend, 0);
  EXPECT_EQ(flight.status, RolloutStatus::ok);

  const auto dragged = box2d::make_backend(
      problem_of(bent(1), 9.8, {.air_drag = 10, .hinge_stiffness = 0}), {.time_step = 1});
  EXPECT_LE(dragged->time_step() * 100, 0.25);
  const auto fast = box2d::make_backend(problem_of(bent(1), 1000), {.time_step = 1});
  EXPECT_LE(fast->time_step() * 1000, 0.4);
}

TEST(Box2dLimits, AChainTooLongOrTooUnevenForSinglePrecisionIsRefused) {
  Points line(2, 5000);
  for (Index i = 0; i < 5000; ++i) line.col(i) = Vector2d(static_cast<double>(i), 0);
  EXPECT_THROW(box2d::make_backend(problem_of(line)), InputError);
  EXPECT_THROW(box2d::make_backend(problem_of(bent(1, 1, 1e-4))), InputError);
  EXPECT_NO_THROW(box2d::make_backend(problem_of(bent(1, 1, 2e-3))));
}

}  // namespace
}  // namespace nuno
