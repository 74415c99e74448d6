#include <nuno/native.h>

#include <nuno/launch.h>
#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene_library.h"

namespace nuno {
namespace {

using std::numbers::pi;

/// A chain alone in space: no gravity, no drag, no damping.
ChainScene in_space(Index particles, double length) {
  ChainScene scene;
  scene.particles = particles;
  scene.arrival_time = 1;
  scene.gravity = 0;
  scene.cloth.air_drag = 0;
  scene.cloth.stretch_damping = 0;
  scene.initial = Points{{0.0, length}, {0.0, 0.0}};
  scene.target = scene.initial;
  return scene;
}

double stored_energy(const Chain& chain, const Points& x) {
  double energy = 0;
  for (Index i = 0; i + 1 < x.cols(); ++i) {
    const double stretch = (x.col(i + 1) - x.col(i)).norm() - chain.rest_length[i];
    energy += 0.5 * chain.material.stretch_stiffness / chain.rest_length[i] * stretch * stretch;
  }
  for (Index i = 0; i + 2 < x.cols(); ++i) {
    const Eigen::Vector2d a = x.col(i + 1) - x.col(i), b = x.col(i + 2) - x.col(i + 1);
    const double angle = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    energy += 0.5 * chain.material.hinge_stiffness / chain.hinge_length[i] * angle * angle;
  }
  return energy;
}

TEST(NativeChain, BeginsWithTheGradientOfItsStoredEnergy) {
  // The first kick lasts h/2, so v = (h/2m)·f; with a step of a nanosecond the tension's own look
  // ahead is nothing. Angles on both sides of every quadrant of the arctangent.
  for (const double turn : {0.3, -0.3, 0.9, 1.5, 1.7, -2.4, 2.9}) {
    ChainScene scene = in_space(4, 0.3);
    const Eigen::Vector2d first(0.1, 0), second(0.1 * std::cos(turn), 0.1 * std::sin(turn));
    scene.initial.resize(2, 4);
    scene.initial << 0, first.x(), first.x() + second.x(), 2 * first.x() + second.x(),  //
        0, 0, second.y(), second.y();
    scene.target = scene.initial;
    scene.cloth.hinge_stiffness = 0.02;
    Problem problem = make_problem(scene);
    problem.arrival_time = 1e-9;
    problem.chain().rest_length.array() *= 0.98;  // stretched, so that tension shows
    const auto backend = native::make_backend(with_time_step(problem, 1e-9));
    const auto cloth = backend->start(Points::Zero(2, 4));
    cloth->step(Points::Zero(2, 4));
    const Points force = cloth->velocities() * problem.chain().particle_mass / (0.5e-9);
    for (Index i = 0; i < 4; ++i) {
      for (Index row = 0; row < 2; ++row) {
        Points ahead = problem.chain().initial, behind = problem.chain().initial;
        ahead(row, i) += 1e-6;
        behind(row, i) -= 1e-6;
        const double expected =
            -(stored_energy(problem.chain(), ahead) - stored_energy(problem.chain(), behind)) /
            2e-6;
        // Central differences: 1e-12 of third derivatives of order 1e4, and rounding 1e-16/1e-6.
        EXPECT_NEAR(force(row, i), expected, 1e-6) << "turn " << turn << " particle " << i;
      }
    }
  }
}

/// The free oscillation's frequency [rad/s], from the zero crossings of a coordinate.
template <typename Coordinate>
double frequency(const Problem& problem, double h, const Points& start_velocity,
                 Coordinate coordinate) {
  const auto backend = native::make_backend(with_time_step(problem, h));
  const auto cloth = backend->start(start_velocity);
  const Points none = Points::Zero(2, problem.chain().particles());
  double last = coordinate(cloth->positions()), first_crossing = 0, last_crossing = 0;
  int crossings = 0;
  for (Index n = 0; n < backend->steps(); ++n) {
    cloth->step(none);
    const double now = coordinate(cloth->positions());
    if (last < 0 && now >= 0) {
      const double at = backend->time_step() * (static_cast<double>(n + 1) - now / (now - last));
      if (crossings++ == 0) first_crossing = at;
      last_crossing = at;
    }
    last = now;
  }
  return 2 * pi * (crossings - 1) / (last_crossing - first_crossing);
}

TEST(NativeChain, SwingsThreeParticlesAtTheFrequencyOfTheirHinge) {
  // Bending of three equal masses: θ = (y₀ − 2y₁ + y₂)/ℓ, so mθ̈ℓ² = −6·kθ.
  ChainScene scene = in_space(3, 0.2);
  scene.arrival_time = 4;
  const Problem problem = make_problem(scene);
  const double l = 0.1, m = problem.chain().particle_mass;
  const double expected = std::sqrt(6 * scene.cloth.hinge_stiffness / l / (m * l * l));
  Points velocity = Points::Zero(2, 3);
  velocity.row(1) << 1e-4, -2e-4, 1e-4;
  const double found = frequency(problem, 1e-4, velocity,
                                 [](const Points& x) { return x(1, 0) - 2 * x(1, 1) + x(1, 2); });
  // (ωh)²/24 of the leapfrog: 2e-7; the amplitude is 1e-5 m.
  EXPECT_NEAR(found / expected, 1, 1e-5);
}

TEST(NativeChain, BendsInTheFirstModeOfAFreeBeam) {
  // ω = (β₁L)²·√(EI/(M·L³)), β₁L = 4.730; a chain of N lumps is 1/N off, so the bar for N = 64 is 1
  // % after the end particles' half segments are counted to the length, L·N/(N − 1).
  double last_error = 0;
  for (const Index particles : {16, 32, 64}) {
    ChainScene scene = in_space(particles, 1);
    scene.arrival_time = 9;
    const Problem problem = make_problem(scene);
    const double length = static_cast<double>(particles) / static_cast<double>(particles - 1);
    const double expected =
        4.73004 * 4.73004 *
        std::sqrt(scene.cloth.hinge_stiffness / (scene.cloth.mass * length * length * length));
    Points velocity = Points::Zero(2, particles);
    for (Index i = 0; i < particles; ++i) {  // the free-free mode
      const double b = 4.73004;
      const double s = (static_cast<double>(i) + 0.5) / static_cast<double>(particles);
      velocity(1, i) = 1e-4 * (std::cosh(b * s) + std::cos(b * s) -
                               0.982502 * (std::sinh(b * s) + std::sin(b * s)));
    }
    const double found = frequency(problem, 5e-4, velocity, [](const Points& x) {
      return 2 * x(1, x.cols() / 2) - x(1, 0) - x(1, x.cols() - 1);
    });
    const double error = std::abs(found / expected - 1);
    EXPECT_LT(error, particles == 64 ? 0.01 : 0.05) << particles;
    if (last_error > 0) {
      EXPECT_LT(error, 0.6 * last_error) << particles;
    }
    last_error = error;
  }
}

TEST(NativeChain, LosesNoEnergyWithoutDamping) {
  ChainScene scene = scene_library::family_member(2);
  scene.gravity = 0;
  scene.cloth.air_drag = 0;
  scene.cloth.stretch_damping = 0;
  const Problem problem = make_problem(scene);
  const auto backend = native::make_backend(with_time_step(problem, 2e-5));
  const Points start = launch(*backend);
  const auto cloth = backend->start(start);
  const double m = problem.chain().particle_mass;
  const double whole =
      stored_energy(problem.chain(), cloth->positions()) + 0.5 * m * start.squaredNorm();
  const Points none = Points::Zero(2, problem.chain().particles());
  double worst = 0;
  Points before = start;
  for (Index n = 0; n < backend->steps(); ++n) {
    before = cloth->velocities();
    const Points x = cloth->positions();
    cloth->step(none);
    if (n == 0) continue;
    // The velocity at the whole step is the mean of those half a step before and after.
    const double kinetic = 0.5 * m * (0.5 * (before + cloth->velocities())).squaredNorm();
    worst = std::max(worst, std::abs(kinetic + stored_energy(problem.chain(), x) - whole));
  }
  // The leapfrog's energy oscillates by (ωh)² of what is in each mode: 1e-3 of the stored part.
  EXPECT_LT(worst / whole, 2e-5);
}

TEST(NativeChain, LosesEnergyToEachDamper) {
  for (int damper = 0; damper < 3; ++damper) {
    ChainScene scene = scene_library::family_member(3);
    scene.gravity = 0;
    scene.cloth.air_drag = damper == 0 ? 0.05 : 0;
    scene.cloth.stretch_damping = damper == 1 ? 6e-2 : 0;
    scene.cloth.hinge_damping = damper == 2 ? 1e-4 : 0;
    scene.launch = damper == 1 ? Launch::ballistic : Launch::inextensible;
    const Problem problem = make_problem(scene);
    const auto backend = native::make_backend(problem);
    const Points start = launch(*backend);
    const auto cloth = backend->start(start);
    const Points none = Points::Zero(2, problem.chain().particles());
    for (Index n = 0; n < backend->steps(); ++n) cloth->step(none);
    const double m = problem.chain().particle_mass;
    const double before =
        stored_energy(problem.chain(), problem.chain().initial) + 0.5 * m * start.squaredNorm();
    const double after = stored_energy(problem.chain(), cloth->positions()) +
                         0.5 * m * cloth->velocities().squaredNorm();
    EXPECT_LT(after, 0.999 * before) << "damper " << damper;
  }
}

TEST(NativeChain, ConvergesWithTheSquareOfTheStep) {
  ChainScene scene = scene_library::straight_to_s();
  scene.launch = Launch::inextensible;
  scene.cloth.stretch_damping = 0;  // the dashpots lag by half a step
  const Problem problem = make_problem(scene);
  const double gain = 0.02;
  const Points exact =
      rollout(*native::make_backend(with_time_step(problem, 1.0 / 102400)), gain).final;
  double last = 0;
  for (const double steps : {1600.0, 3200.0, 6400.0}) {
    const Points final =
        rollout(*native::make_backend(with_time_step(problem, 1 / steps)), gain).final;
    const double error = arrival_error(final, exact).mean;
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.3) << steps;
    }
    last = error;
  }
}

TEST(NativeChain, NeedsNoSmallerStepForAStifferThread) {
  ChainScene scene = scene_library::straight_to_s();
  scene.launch = Launch::inextensible;
  const Index steps = native::make_backend(make_problem(scene))->steps();
  scene.cloth.stretch_stiffness = 2e8;
  const Problem problem = make_problem(scene);
  const auto backend = native::make_backend(problem);
  EXPECT_EQ(backend->steps(), steps);
  const Rollout flight = rollout(*backend, 0.02);
  EXPECT_EQ(flight.status, RolloutStatus::ok);
  EXPECT_NEAR(segment_lengths(flight.final).sum(), problem.chain().size, 1e-4);
}

ChainScene inextensible_s(Index particles) {
  ChainScene scene = scene_library::straight_to_s();
  scene.particles = particles;
  scene.launch = Launch::inextensible;
  scene.cloth.stretch_damping = 0;  // the dashpots lag by half a step
  return scene;
}

TEST(NativeChain, NeedsNoSmallerStepForMoreParticles) {
  const auto usual = native::make_backend(make_problem(inextensible_s(32)));
  for (const Index particles : {100, 300, 1000}) {
    const Problem problem = make_problem(inextensible_s(particles));
    const auto backend = native::make_backend(problem);
    EXPECT_LE(backend->steps(), 2 * usual->steps());
    const auto fine = native::make_backend(with_time_step(problem, backend->time_step() / 8));
    // The same force on the whole cloth.
    const std::vector<double> gains = {0, 0.01 * 32 / static_cast<double>(particles),
                                       0.02 * 32 / static_cast<double>(particles)};
    const std::vector<double> found = backend->errors(gains), exact = fine->errors(gains);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      EXPECT_NEAR(found[i], exact[i], 1e-4) << particles << " particles, gain " << gains[i];
    }
  }
}

// From 1000 steps on, where the thread's own waves are resolved; at the default, 400, all that is
// left is 1e-5 of L.
TEST(NativeChain, ImplicitHingesAreOfSecondOrder) {
  for (const Index particles : {300, 1000}) {
    const Problem problem = make_problem(inextensible_s(particles));
    const double gain = 0.02 * 32 / static_cast<double>(particles);
    const auto arrive = [&](double steps) {
      const auto backend = native::make_backend(with_time_step(problem, 1 / steps));
      EXPECT_EQ(backend->steps(), steps);
      return rollout(*backend, gain).final;
    };
    const Points coarse = arrive(1000), middle = arrive(2000), fine = arrive(4000);
    const double order =
        std::log2(arrival_error(coarse, middle).mean / arrival_error(middle, fine).mean);
    EXPECT_NEAR(order, 2, 0.2) << particles;
  }
}

TEST(NativeChain, ImplicitHingesSwingUndampedWhereTheStepResolvesThem) {
  // The first mode of a free beam of 300 particles, for a hundred periods of ωh = 0.1, which is ten
  // thousand times the step that explicit hinges would be stable at.
  ChainScene scene = in_space(300, 1);
  scene.launch = Launch::inextensible;
  scene.cloth.stretch_stiffness = 2e4;
  const double b = 4.73004, length = 300.0 / 299;
  const double frequency =
      b * b * std::sqrt(scene.cloth.hinge_stiffness / (scene.cloth.mass * std::pow(length, 3)));
  scene.arrival_time = 100 * 2 * pi / frequency;
  const Problem problem = make_problem(scene);
  const auto backend = native::make_backend(with_time_step(problem, 0.1 / frequency));
  Points start = Points::Zero(2, 300);
  for (Index i = 0; i < 300; ++i) {
    const double s = (static_cast<double>(i) + 0.5) / 300;
    start(1, i) = 1e-3 * (std::cosh(b * s) + std::cos(b * s) -
                          0.982502 * (std::sinh(b * s) + std::sin(b * s)));
  }
  const auto cloth = backend->start(start);
  const Points none = Points::Zero(2, 300);
  const double m = problem.chain().particle_mass;
  const double whole = 0.5 * m * start.squaredNorm();
  double first = 0, last = 0;  // largest kinetic energy over the first and the last two periods
  for (Index n = 0; n < backend->steps(); ++n) {
    cloth->step(none);
    const double kinetic = 0.5 * m * cloth->velocities().squaredNorm();
    if (n < 126) first = std::max(first, kinetic);
    if (n >= backend->steps() - 126) last = std::max(last, kinetic);
  }
  // Sampled every 0.1 rad, a maximum is up to 0.05² = 2.5e-3 off; 126 steps hold four of them, two
  // of which lie within 0.015 rad of a sample.
  EXPECT_NEAR(first, whole, 5e-3 * whole);
  EXPECT_NEAR(last, first, 1e-3 * first);
}

TEST(NativeChain, CutsAStepThatDoesNotResolveTheCloth) {
  ChainScene scene = scene_library::straight_to_s();
  scene.cloth.hinge_stiffness = 0.1;
  const Problem problem = make_problem(scene);
  const auto backend = native::make_backend(with_time_step(problem, 0.5));
  EXPECT_LT(backend->time_step(), 1e-3);
  const Rollout flight = rollout(*backend, 0.1);
  EXPECT_EQ(flight.status, RolloutStatus::ok);
  EXPECT_LT(flight.error.max, 2 * problem.chain().size);
}

TEST(NativeChain, TakesAStepThatIsStable) {
  const Problem problem = make_problem(scene_library::straight_to_s());
  EXPECT_EQ(native::make_backend(with_time_step(problem, 1e-4))->steps(), 10'000);
  EXPECT_EQ(native::make_backend(with_time_step(problem, 3e-4))->steps(),
            3334);  // a whole number ends at t₀
}

TEST(NativeBatch, GivesTheBitsOfOneRolloutEach) {
  for (const std::uint64_t n : {0u, 1u, 7u, 8u}) {
    ChainScene scene = scene_library::family_member(n);
    if (n == 8) scene.particles = 200;  // implicit hinges
    if (n == 1) scene.cloth.hinge_damping = 1e-6;
    if (n == 7) scene.damping_ratio = 0.6;
    const Problem problem = make_problem(scene);
    const auto backend = native::make_backend(problem);
    std::vector<double> gains;
    for (int i = 0; i < 19; ++i) gains.push_back(0.01 * i);
    const std::vector<double> errors = backend->errors(gains);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      EXPECT_EQ(errors[i], rollout(*backend, gains[i]).error.mean) << gains[i];
    }
  }
}

void expect_derivatives(const ChainScene& scene) {
  const Problem problem = make_problem(scene);
  const auto backend = native::make_backend(problem);
  std::vector<double> gains;
  for (int i = 1; i < 12; ++i)
    gains.push_back(0.004 * i * 32 / static_cast<double>(scene.particles));
  const std::vector<ErrorSample> samples = backend->error_samples(gains);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    const double d = 1e-5 * gains[i];
    const std::vector<double> around = backend->errors(
        std::vector<double>{gains[i] - 2 * d, gains[i] - d, gains[i] + d, gains[i] + 2 * d});
    const double difference = (around[0] - 8 * around[1] + 8 * around[2] - around[3]) / (12 * d);
    // Fourth-order differences: rounding 1e-14/d = 1e-7 of derivatives of order 1.
    EXPECT_NEAR(samples[i].derivatives[0].error, difference, 1e-6 * std::abs(difference) + 1e-7)
        << gains[i];
    EXPECT_EQ(samples[i].error, backend->errors({&gains[i], 1}).front());
  }
}

TEST(NativeBatch, KnowsTheDerivativeOfTheError) {
  expect_derivatives(scene_library::straight_to_s());
  expect_derivatives(inextensible_s(150));  // implicit hinges
}

TEST(NativeBatch, KeepsADivergedGainToItself) {
  const Problem problem = make_problem(scene_library::straight_to_s());
  const auto backend = native::make_backend(problem);
  const std::vector<double> gains = {0.01, 1e12, 0.02};
  const std::vector<double> errors = backend->errors(gains);
  EXPECT_EQ(errors[0], rollout(*backend, 0.01).error.mean);
  EXPECT_EQ(errors[2], rollout(*backend, 0.02).error.mean);
  EXPECT_EQ(errors[1], std::numeric_limits<double>::infinity());
  EXPECT_EQ(rollout(*backend, 1e12).status, RolloutStatus::diverged);
}

}  // namespace
}  // namespace nuno
