// Hinges of Box2D's joints: have they the moment of their law?

#include <nuno/box2d.h>
#include <nuno/launch.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "bare_problem.h"

#include <cmath>
#include <numbers>

namespace nuno {
namespace {

using box2d::Hinge;
using Eigen::Vector2d;
using std::numbers::pi;

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
double measured_moment(const Points& shape, const Points& velocities, const ChainMaterial& cloth,
                       Hinge form) {
  const auto backend = box2d::make_backend_with({.hinge = form, .velocity_iterations = 200},
                                                with_time_step(problem_of(shape, 0, cloth), 1e-5));
  const auto chain = backend->start(backend->problem().chain().initial, velocities);
  chain->step(Points::Zero(2, 3));
  const double mass = backend->problem().chain().particle_mass;
  const Points response = without_stretching(shape, straightening_forces(shape)) / mass;
  const Points gained = chain->velocities() - velocities;
  return gained.cwiseProduct(response).sum() / response.squaredNorm() / (backend->time_step() / 2);
}

TEST(Box2dHinge, TheWeldHasTheMomentOfItsLawUpTo2AndAHalfRadians) {
  const ChainMaterial cloth = {.air_drag = 0, .hinge_stiffness = 0.01};
  for (const double angle : {-2.5, -1.0, 0.01, 0.3, 1.0, 1.7, 2.0, 2.5}) {
    const double law = cloth.hinge_stiffness * angle / 0.4;
    const double moment = measured_moment(bent(angle), Points::Zero(2, 3), cloth, Hinge::soft_weld);
    // Single precision of the difference of two rods' angles, 2e-7 rad.
    EXPECT_NEAR(moment, law, 1e-4 * std::abs(law)) << angle;
  }
}

TEST(Box2dHinge, TheSpringPairHasTheMomentOfItsGeometryToTheEndOfItsRange) {
  const ChainMaterial cloth = {.air_drag = 0, .hinge_stiffness = 0.01};
  for (const double angle : {-1.69, -1.0, 0.1, 0.3, 1.0, 1.5, 1.69}) {
    const double phi = angle / 2;
    const double law = cloth.hinge_stiffness * angle / 0.4;
    const double geometry = cloth.hinge_stiffness / 0.4 * 2 * std::sin(phi) *
                            (4.0 / 3 * (1 - std::cos(phi)) + std::cos(phi));
    const double moment =
        measured_moment(bent(angle), Points::Zero(2, 3), cloth, Hinge::spring_pair);
    // Single precision of the springs' lengths, 1e-7 of up to 0.01 that they are stretched.
    EXPECT_NEAR(moment, geometry, 3e-4 * std::abs(law)) << angle;
    EXPECT_NEAR(moment, law, 0.02 * std::abs(law)) << angle;  // what the header says
  }
}

TEST(Box2dHinge, ADashpotBrakesTheTurning) {
  const ChainMaterial cloth = {.air_drag = 0, .hinge_stiffness = 0, .hinge_damping = 1e-2};
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

// Dashpots that nothing bends make a rod of the thread at once, which keeps its shape and the
// angular momentum that the thread was launched with.
TEST(Box2dHinge, RigidDashpotsMakeOneRodOfTheThread) {
  constexpr Index particles = 13;
  Points shape(2, particles), velocities(2, particles);
  for (Index i = 0; i < particles; ++i) {
    const double s = static_cast<double>(i) / (particles - 1);
    shape.col(i) << s, 0.3 * std::sin(5 * s);
    velocities.col(i) << std::cos(7 * s), 3 * s - std::sin(9 * s);
  }
  for (const double damping : {10.0, 1e9}) {
    const Problem problem = problem_of(shape, 0, {.air_drag = 0, .hinge_damping = damping});
    const auto backend = box2d::make_backend(problem);
    EXPECT_EQ(backend->steps(), 1000);
    const auto thread = backend->start(shape, velocities);
    for (Index n = 0; n < backend->steps(); ++n) thread->step(Points::Zero(2, particles));

    const Points arms = shape_of(shape), motion = shape_of(velocities);
    const double momentum =
        (arms.row(0).cwiseProduct(motion.row(1)) - arms.row(1).cwiseProduct(motion.row(0))).sum();
    const Eigen::Rotation2Dd turned(momentum / arms.squaredNorm() * problem.arrival_time);
    const Points expected = turned.toRotationMatrix() * arms;
    const Points apart = shape_of(thread->positions()) - expected;
    EXPECT_LT(apart.colwise().norm().maxCoeff(), 1e-3) << damping;
  }
}

TEST(Box2dHinge, ASmallBendingSwingsAtItsFrequency) {
  // Three particles in the motion (1, −2, 1)·s: θ = 6s/ℓ, energies ½·6m·ṡ² and ½·k·36s²/ℓ².
  const double length = 0.5;
  const ChainMaterial cloth = {.air_drag = 0, .hinge_stiffness = 1e-3};
  Problem problem = problem_of(bent(0.02, length, length), 0, cloth);
  const double stiffness = cloth.hinge_stiffness / length;
  const double frequency =
      std::sqrt(stiffness * 6 / (problem.chain().particle_mass * length * length));
  problem.arrival_time = 10 * 2 * pi / frequency;
  for (const Hinge form : {Hinge::soft_weld, Hinge::spring_pair}) {
    const auto backend =
        box2d::make_backend_with({.hinge = form}, with_time_step(problem, 0.02 / frequency));
    const auto chain = backend->start(backend->problem().chain().initial, Points::Zero(2, 3));
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

// A step of any length, on its own recurrence: the spring is that of the mean of the angles before
// and after,
//     θ₊ − 2θ + θ₋ = −h²ω²·(θ₊ + θ₋)/2.
TEST(Box2dHinge, ASpringIsTheMeanOfBeforeAndAfterAtAnyStep) {
  const double length = 0.5;
  const ChainMaterial cloth = {.air_drag = 0, .hinge_stiffness = 1e-3};
  Problem problem = problem_of(bent(0.02, length, length), 0, cloth);
  const double stiffness = cloth.hinge_stiffness / length;
  const double frequency =
      std::sqrt(stiffness * 6 / (problem.chain().particle_mass * length * length));
  for (const double phase : {0.3, 1.0, 3.0, 10.0}) {
    problem.arrival_time = 60 * phase / frequency;
    for (const Hinge form : {Hinge::soft_weld, Hinge::spring_pair}) {
      const auto backend =
          box2d::make_backend_with({.hinge = form}, with_time_step(problem, phase / frequency));
      if (form == Hinge::spring_pair && phase > 0.4) {
        EXPECT_GT(backend->steps(), 60);  // springs of a pair are not for such steps
        continue;
      }
      ASSERT_EQ(backend->steps(), 60);
      const auto chain = backend->start(backend->problem().chain().initial, Points::Zero(2, 3));
      double before = 0.02, now = 0.02;
      for (Index n = 0; n < 60; ++n) {
        chain->step(Points::Zero(2, 3));
        const double after = hinge_angle(chain->positions());
        ASSERT_LT(std::abs(after), 1.1 * 0.02) << "phase " << phase << " step " << n;
        // The first step is half a kick from rest. Joint impulses lag, the more the longer the
        // step: 1 % of the largest change at these.
        if (n > 0 && phase <= 1) {
          const double mean = phase * phase * (after + before) / 2;
          ASSERT_NEAR(after - 2 * now + before, -mean, 0.02 * phase * phase * 0.01)
              << "phase " << phase << " step " << n;
        }
        before = now;
        now = after;
      }
    }
  }
}

TEST(Box2dHinge, AHingeThatTurnsThroughHalfATurnIsPulledOnTheOtherWay) {
  const ChainMaterial cloth = {.air_drag = 0, .hinge_stiffness = 0.01};
  const Points shape = bent(3.1, 0.5, 0.5);
  const Points turning = without_stretching(shape, -straightening_forces(shape)) * 0.5;
  const auto backend = box2d::make_backend(with_time_step(problem_of(shape, 0, cloth), 1e-4));
  const auto chain = backend->start(backend->problem().chain().initial, turning);
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
  EXPECT_NO_THROW(box2d::make_backend_with({.hinge = Hinge::soft_weld}, problem));
  try {
    box2d::make_backend_with({.hinge = Hinge::spring_pair}, problem);
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
    const auto backend = box2d::make_backend_with({.hinge = form}, problem_of(shape));
    const auto chain = backend->start(backend->problem().chain().initial, turning);
    while (chain->positions().allFinite() && hinge_angle(chain->positions()) < 1.8) {
      chain->step(Points::Zero(2, 3));
    }
    EXPECT_EQ(chain->positions().allFinite(), form == Hinge::soft_weld);
    EXPECT_EQ(chain->failure(), form == Hinge::soft_weld
                                    ? ""
                                    : "a hinge turns further than its pair of springs reaches");
  }
}

}  // namespace
}  // namespace nuno
