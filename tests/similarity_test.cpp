// Results do not depend on the units of length, time and force that a scene is given in.

#include <nuno/feasibility.h>
#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "engines.h"
#include "scene_library.h"
#include "sheets.h"
#include "units.h"

namespace nuno {
namespace {

/// Makes a scene's problem, its numbers meant in some units.
using MakeProblem = std::function<Problem(const Units&)>;

template <class AnyScene>
MakeProblem problems_of(const AnyScene& scene) {
  return [scene](const Units& units) { return make_problem(in_units(scene, units)); };
}

/// A chain under the paper's control, one under damped control of a moving reference, both with
/// explicit hinges; and one whose dashpots are so strong that they are implicit.
std::vector<MakeProblem> chains() {
  ChainScene held = scene_library::family_member(0);
  held.particles = 16;
  ChainScene followed = scene_library::family_member(4);
  followed.particles = 12;
  followed.reference = Reference::morph;
  followed.damping_ratio = 0.7;
  followed.cloth.hinge_damping = 1e-5;
  ChainScene stiff = scene_library::straight_to_s();
  stiff.particles = 12;
  stiff.cloth.hinge_stiffness = stiff.cloth.hinge_damping = 0.01;
  return {problems_of(held), problems_of(followed), problems_of(stiff)};
}

/// A sheet of quads under the paper's control, and one of quads and triangles under damped control
/// of a moving reference, with every dashpot.
std::vector<MakeProblem> sheets() {
  SheetScene held = throw_scene(true, 3);
  held.reference = Reference::hold;
  held.damping_ratio = 0;
  SheetScene followed = throw_scene(false, 4);
  followed.cloth.bending_damping = 1e-5;
  followed.launch = Launch::inextensible;
  return {problems_of(held), problems_of(followed)};
}

/// An engine and a form of cloth that it flies.
struct Pair {
  const char* name;
  const Engine* engine;
  std::vector<MakeProblem> (*problems)();
  /// How far rounding may take a calm flight, over L, and a gain, relative.
  double rounding;
};

struct NamedUnits {
  std::string name;
  Units units;
  bool rounds;  ///< a scene's numbers do not read the same to the last bit
};

std::vector<NamedUnits> all_units() {
  std::vector<NamedUnits> all;
  for (const auto& [factor, name] : {std::pair{1e-3, "thousandths"}, std::pair{1e3, "thousands"},
                                     std::pair{0x1p-10, "binary"}}) {
    const bool rounds = std::exp2(std::round(std::log2(factor))) != factor;
    all.push_back({std::string("length_in_") + name, {.length = factor}, rounds});
    all.push_back({std::string("time_in_") + name, {.time = factor}, rounds});
    all.push_back({std::string("force_in_") + name, {.force = factor}, rounds});
  }
  return all;
}

class Similarity : public testing::TestWithParam<std::tuple<Pair, NamedUnits>> {
 protected:
  static const Pair& pair() { return std::get<0>(GetParam()); }
  static const Units& units() { return std::get<1>(GetParam()).units; }
  static double rounding() { return std::get<1>(GetParam()).rounds ? pair().rounding : 0; }

  static std::unique_ptr<Backend> make(const MakeProblem& problem, const Units& units) {
    return pair().engine->make(problem(units), std::nullopt);
  }
};

TEST_P(Similarity, OfFlights) {
  for (const MakeProblem& problem : pair().problems()) {
    const auto plain = make(problem, {}), other = make(problem, units());
    EXPECT_EQ(other->steps(), plain->steps());
    const double largest = other->largest_gain() / units().gain();
    EXPECT_NEAR(largest, plain->largest_gain(), 1e-12 * plain->largest_gain());
    EXPECT_EQ(verdict(assess(*other)), verdict(assess(*plain)));
    const double size = plain->cloth().size;
    for (const double scales : {0.0, 10.0}) {
      const double gain = scales * gain_scale(plain->problem());
      const Rollout a = rollout(*plain, gain), b = rollout(*other, gain * units().gain());
      EXPECT_LE(farthest(b.final / units().length, a.final), rounding() * size) << gain;
      EXPECT_NEAR(b.error.mean / units().length, a.error.mean, rounding() * size) << gain;
      EXPECT_NEAR(b.control_effort, a.control_effort, rounding()) << gain;
      EXPECT_NEAR(b.max_strain, a.max_strain, rounding()) << gain;
      // Of a perturbation of 1e-8 in double precision and 1e-4 in single.
      EXPECT_NEAR(sensitivity(*other, b), sensitivity(*plain, a), rounding() > 0 ? 1e-2 : 0)
          << gain;
    }
  }
}

TEST_P(Similarity, OfTheBestGain) {
  const MakeProblem problem = pair().problems()[1];  // damped, which takes few flights
  const auto search = [&](const Units& units) {
    const auto backend = make(problem, units);
    return global_search(objective(*backend), {.scan = 5, .brackets = 1, .rounds = 6});
  };
  const OptimizeSummary plain = search({}), other = search(units());
  // A minimum is flat: its place is known by the root of its value only.
  EXPECT_NEAR(other.gain / units().gain(), plain.gain, 1e3 * rounding() * plain.gain);
  EXPECT_NEAR(other.error / units().length, plain.error, 1e2 * rounding() * plain.error);
  if (rounding() == 0) {
    EXPECT_EQ(other.evaluations, plain.evaluations);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Engines, Similarity,
    testing::Combine(testing::Values(Pair{"chain_on_native", &native_engine, chains, 1e-10},
                                     Pair{"chain_on_box2d", &box2d_weld_engine, chains, 1e-5},
                                     Pair{"sheet_on_native", &native_engine, sheets, 1e-10},
                                     Pair{"sheet_on_bullet", &bullet_engine, sheets, 1e-5}),
                     testing::ValuesIn(all_units())),
    [](const auto& of) {
      return std::string(std::get<0>(of.param).name) + "_" + std::get<1>(of.param).name;
    });

}  // namespace
}  // namespace nuno
