// What the steps that an engine chooses by itself hold, whatever the cloth's size, its flight and
// its place.

#include <nuno/conditioning.h>
#include <nuno/engines.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "sheets.h"

namespace nuno {
namespace {

/// A ribbon of the default cloth, thrown from a line three lengths far into an arch.
struct Throw {
  double length;         // [m]
  double arrival_time;   // [s]
  double hinge_damping;  // [N·m²·s]
};

ChainScene scene_of(const Throw& thrown, Index particles) {
  ChainScene scene;
  scene.particles = particles;
  scene.arrival_time = thrown.arrival_time;
  scene.initial = thrown.length * Points{{0, 1}, {1, 1}};
  scene.target = thrown.length * Points{{3.0, 3.2, 3.5, 3.8, 4.0}, {1.0, 1.3, 1.4, 1.3, 1.0}};
  scene.cloth.hinge_damping = thrown.hinge_damping;
  return scene;
}

/// How far the centroid may be off [m]. On Box2D 1e-4 L: single precision. Native adds up its
/// places, 4 km high in a flight of a minute, in double precision.
double tolerance(std::string_view engine, const Throw& thrown, double gravity) {
  if (engine != "native") return 1e-4 * thrown.length;
  const double height = gravity * thrown.arrival_time * thrown.arrival_time / 8;
  return 1e-9 * thrown.length + 1e-14 * height;
}

class DefaultStep : public testing::TestWithParam<std::string_view> {};

TEST_P(DefaultStep, BringsTheCentroidHomeWhateverTheSizeTheTimeAndTheDamping) {
  for (const double length : {0.01, 0.1, 1.0, 1e3}) {
    for (const double time : {0.05, 1.0, 10.0, 60.0}) {
      for (const double damping : {0.0, 1e-3, 1e-2}) {
        const Throw thrown{length, time, damping};
        const SceneFile file = make_scene_file("ribbon", scene_of(thrown, 8));
        const auto backend = make_backend(GetParam(), file);
        for (const double scales : {0.0, 1.0, 100.0}) {
          if (backend->steps() > 20'000 && scales != 1) continue;  // seconds
          const Rollout flight = rollout(*backend, scales * gain_scale(file.problem));
          EXPECT_LE(flight.error.centroid, tolerance(GetParam(), thrown, file.scene.gravity))
              << length << " m, " << time << " s, " << damping << " N·m²·s, gain × " << scales;
        }
      }
    }
  }
}

TEST_P(DefaultStep, TakesAFlightFarFromTheOriginForTheSameFlight) {
  const auto at = [](double place) {
    ChainScene scene = scene_of({.length = 1, .arrival_time = 1, .hinge_damping = 0}, 16);
    scene.initial.row(0).array() += place;
    scene.target.row(0).array() += place;
    return make_scene_file("ribbon", scene);
  };
  const auto here = make_backend(GetParam(), at(0));
  for (const double place : {1e6, 1e8}) {
    const auto there = make_backend(GetParam(), at(place));
    const double digit = 2e-16 * place;  // what a coordinate there can tell apart
    for (const double scales : {0.0, 1.0}) {
      const double gain = scales * gain_scale(here->problem());
      const Rollout near = rollout(*here, gain), far = rollout(*there, gain);
      EXPECT_LE(far.error.centroid, 1e-9 + 10 * digit) << place;
      EXPECT_LE(shape_difference(here->cloth(), near.final, far.final).max, 1e-6 + 100 * digit)
          << place;
      const double growth = bounded_sensitivity(*here, near);
      EXPECT_NEAR(bounded_sensitivity(*there, far), growth, 0.1 * std::max(1.0, growth)) << place;
    }
  }
}

TEST(StrongDashpots, AreNoReasonForShorterSteps) {
  for (const double length : {0.01, 0.1, 1.0}) {
    for (const double damping : {1e-2, 1e4}) {
      const auto steps_on = [&](std::string_view engine, double hinge_damping) {
        const Throw thrown{.length = length, .arrival_time = 1, .hinge_damping = hinge_damping};
        return make_backend(engine, make_scene_file("ribbon", scene_of(thrown, 8)))->steps();
      };
      EXPECT_EQ(steps_on("box2d", damping), steps_on("box2d", 0)) << length << " m";
      EXPECT_LE(steps_on("native", damping), 20'000) << length << " m";
    }
  }
}

TEST(StrongDashpots, DoNotBurstOnBox2dWhateverTheGain) {
  int flown = 0;
  for (const double length : {0.01, 0.03, 0.3}) {
    for (const Index particles : {8, 25, 54}) {
      for (const double damping : {1e-4, 1e-2, 1.0}) {
        const Throw thrown{.length = length, .arrival_time = 1, .hinge_damping = damping};
        const SceneFile file = make_scene_file("ribbon", scene_of(thrown, particles));
        const auto box2d = make_backend("box2d", file);
        if (box2d->steps() > 4000) continue;  // for its springs
        for (const double scales : {10.0, 300.0}) {
          const Rollout flight = rollout(*box2d, scales * gain_scale(file.problem));
          ++flown;
          EXPECT_FALSE(diverged(flight)) << length << " m, " << particles << " particles, "
                                         << damping << " N·m²·s, gain × " << scales;
        }
      }
    }
  }
  EXPECT_GE(flown, 36);
}

// Moments of a rigid chain go with the square of its particles.
TEST(StrongDashpots, KeepLongThreadsTogether) {
  for (const Index particles : {256, 1024}) {
    ChainScene scene = scene_of({.length = 1, .arrival_time = 1, .hinge_damping = 1}, particles);
    scene.cloth.hinge_stiffness = 1e-8;
    const SceneFile file = make_scene_file("ribbon", scene);
    const auto native = make_backend("native", file), box2d = make_backend("box2d", file);
    for (const double scales : {0.0, 100.0}) {
      const double gain = scales * gain_scale(file.problem);
      const Points here = rollout(*native, gain).final, there = rollout(*box2d, gain).final;
      EXPECT_LE(shape_difference(native->cloth(), here, there).max, 2e-3)
          << particles << " particles, gain × " << scales;
    }
  }
}

// A chain's highest bending wave has ω² = 16·k/(m·ℓ²), and its dashpots the rate c alike.
TEST(StrongDashpots, BurstBesideNoSpring) {
  ChainScene scene = scene_of({.length = 1, .arrival_time = 1, .hinge_damping = 0}, 32);
  scene.launch = Launch::inextensible;
  const Problem limp = make_problem(scene);
  const Chain& chain = limp.chain();
  const double per_hinge = 16 / (chain.hinge_length.minCoeff() *
                                 std::pow(chain.rest_length.minCoeff(), 2) * chain.particle_mass);
  const double step = scene.arrival_time / 1000;
  for (const double spring : {10.0, 100.0, 599.0}) {                            // h²ω²
    for (const double dashpot : {2.0, 29.0, 31.0, 101.0, 598.0, 601.0, 1e6}) {  // hc
      scene.cloth.hinge_stiffness = spring / (step * step * per_hinge);
      scene.cloth.hinge_damping = dashpot / (step * per_hinge);
      const SceneFile file = make_scene_file("s", scene);
      const auto box2d = make_backend("box2d", file);
      EXPECT_EQ(box2d->steps(), 1000);
      for (const double scales : {0.0, 300.0}) {
        const Rollout flight = rollout(*box2d, scales * gain_scale(file.problem));
        EXPECT_LT(flight.max_strain, 1e-3)
            << "h²ω² = " << spring << ", hc = " << dashpot << ", gain × " << scales;
      }
    }
  }
}

TEST(StrongDashpots, LeadBothEnginesToOneShape) {
  for (const double length : {0.01, 0.1}) {
    for (const double damping : {1e-4, 1e-3, 1e-2}) {
      const Throw thrown{.length = length, .arrival_time = 1, .hinge_damping = damping};
      const SceneFile file = make_scene_file("ribbon", scene_of(thrown, 16));
      const auto native = make_backend("native", file), box2d = make_backend("box2d", file);
      for (const double scales : {0.0, 10.0}) {
        const double gain = scales * gain_scale(file.problem);
        const Points here = rollout(*native, gain).final, there = rollout(*box2d, gain).final;
        EXPECT_LE(shape_difference(native->cloth(), here, there).max, 1e-3 * length)
            << length << " m, " << damping << " N·m²·s, gain × " << scales;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EachOf, DefaultStep, testing::ValuesIn(chain_engines),
                         [](const auto& engine) { return std::string(engine.param); });

}  // namespace
}  // namespace nuno
