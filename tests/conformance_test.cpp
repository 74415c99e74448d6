// What every engine promises of every cloth that it flies, one suite over all of them.

#include <nuno/launch.h>
#include <nuno/optimize.h>
#include <nuno/rollout.h>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>
#include <variant>

#include "engines.h"
#include "own_engine.h"
#include "scene_library.h"
#include "sheets.h"
#include "units.h"

namespace nuno {
namespace {

using std::numbers::pi;

using ClothScene = std::variant<ChainScene, SheetScene>;

const Engine own_engine = {"own",
                           [](const Problem& problem, std::optional<double> time_step) {
                             return own::make_backend(with_time_step(problem, time_step));
                           },
                           1e-11, false};

/// What a scene asks, whatever its cloth's form.
Scene& common(ClothScene& scene) {
  return std::visit([](Scene& any) -> Scene& { return any; }, scene);
}

Problem problem_of(const ClothScene& scene) {
  return std::visit([](const auto& any) { return make_problem(any); }, scene);
}

void set_air_drag(ClothScene& scene, double drag) {
  std::visit([drag](auto& any) { any.cloth.air_drag = drag; }, scene);
}

/// A scene whose shapes are those of another, each changed alike.
template <class Change>
ClothScene with_shapes(ClothScene scene, const Change& change) {
  const auto apply = [&](auto& any) {
    any.initial = Points(change(any.initial));
    any.target = Points(change(any.target));
  };
  std::visit(apply, scene);
  return scene;
}

/// An engine and a form of cloth that it flies.
struct Pair {
  const char* name;
  const Engine* engine;
  bool is_sheet;
};

SheetScene held_sheet(bool all_quads) {
  SheetScene scene = throw_scene(all_quads);
  scene.reference = Reference::hold;
  scene.damping_ratio = 0;
  return scene;
}

/// Well-conditioned throws: a chain's of the library, a gentle one and two of the family; a sheet's
/// of quads that is held and of quads and triangles that is held and that follows a motion.
std::vector<ClothScene> calm_scenes(const Pair& pair) {
  std::vector<ClothScene> scenes;
  if (pair.is_sheet) {
    scenes = {held_sheet(true), held_sheet(false), throw_scene(false)};
  } else {
    scenes = {scene_library::straight_to_s(), scene_library::family_member(0),
              scene_library::family_member(4)};
  }
  for (ClothScene& scene : scenes) common(scene).launch = Launch::inextensible;
  return scenes;
}

/// Shapes that are hard to start from: a chain's hairpin and a fold to 170°; a sheet folded as far,
/// and rolled up into a tube whose ends all but meet.
std::vector<ClothScene> hard_starts(const Pair& pair) {
  const double back = 170 * pi / 180;
  std::vector<ClothScene> scenes;
  if (!pair.is_sheet) {
    for (const Points& initial :
         {Points{{0.0, 1.0, 0.01}, {0.0, 0.0, 0.02}},
          Points{{0.0, 0.5, 0.5 + 0.5 * std::cos(back)}, {0.0, 0.0, 0.5 * std::sin(back)}}}) {
      ChainScene scene = scene_library::straight_to_s();
      scene.initial = initial;
      scenes.emplace_back(scene);
    }
    return scenes;
  }
  SheetScene folded = held_sheet(true), tube = folded;
  for (Index i = 0; i < folded.initial.cols(); ++i) {
    const double x = folded.initial(0, i), turn = x / 0.8 * 0.99 * 2 * pi;
    if (x > 0) folded.initial.col(i).head<2>() << x * std::cos(back), x * std::sin(back);
    tube.initial.col(i).head<2>() << std::sin(turn), 1 - std::cos(turn);
    tube.initial.col(i).head<2>() *= 0.8 / (2 * pi);
  }
  return {folded, tube};
}

/// A gain below every calm scene's best one [N/m].
double calm_gain(const Problem& problem) {
  return problem.cloth().particle_mass / (problem.arrival_time * problem.arrival_time);
}

class EveryEngine : public testing::TestWithParam<Pair> {
 protected:
  static ClothScene plain() {
    if (GetParam().is_sheet) return held_sheet(true);
    return scene_library::straight_to_s();
  }
  static std::unique_ptr<Backend> make(const ClothScene& scene,
                                       std::optional<double> time_step = std::nullopt) {
    return GetParam().engine->make(problem_of(scene), time_step);
  }
  static Points final_shape(const ClothScene& scene, double gain) {
    return rollout(*make(scene), gain).final;
  }
  static double rounding() { return GetParam().engine->rounding; }
};

TEST_P(EveryEngine, FliesAFreeClothByItsOwnRecurrence) {
  ClothScene scene = plain();
  set_air_drag(scene, 0.2);
  const auto backend = make(scene);
  const DragRecurrence r = backend->drag_recurrence();
  const Points& initial = backend->cloth().initial;
  Vector v = Eigen::Vector3d(3, 5, -1).head(initial.rows());
  Vector x = Vector::Zero(initial.rows());
  const auto cloth = backend->start(v.replicate(1, initial.cols()));
  const Points none = Points::Zero(initial.rows(), initial.cols());
  for (Index n = 0; n < backend->steps(); ++n) {
    cloth->step(none);
    v *= n == 0 ? r.r1 : r.r;
    v[1] -= (n == 0 ? r.q1 : r.q) * backend->cloth().gravity;
    x += r.h * v;
    const Points moved = cloth->positions() - initial;
    ASSERT_LT((moved.colwise() - x).colwise().norm().maxCoeff(), rounding()) << "step " << n;
  }
}

TEST_P(EveryEngine, BringsTheCentroidHomeAtEveryGain) {
  for (ClothScene& scene : calm_scenes(GetParam())) {
    const auto backend = make(scene);
    for (const double times : {0.0, 1.0, 10.0, 100.0}) {
      const Rollout flight = rollout(*backend, times * calm_gain(backend->problem()));
      EXPECT_LT(flight.error.centroid, rounding()) << common(scene).name << ", gain × " << times;
    }
  }
}

TEST_P(EveryEngine, KeepsAWholeNumberOfStepsUntilArrival) {
  ClothScene scene = plain();
  common(scene).arrival_time = 0.777;
  for (const double wish : {1e-3, 3.3e-4, 1e-4}) {
    const auto backend = make(scene, wish);
    EXPECT_LE(backend->time_step(), wish * (1 + 1e-12));
    EXPECT_NEAR(backend->time_step() * static_cast<double>(backend->steps()), 0.777, 1e-12);
  }
}

TEST_P(EveryEngine, GivesTheSameAnswerTwiceAndInThreads) {
  const auto backend = make(plain());
  const double gain = 4 * calm_gain(backend->problem());
  const Points first = rollout(*backend, gain).final;
  std::vector<Points> finals(4);
  {
    std::vector<std::jthread> threads;
    for (Points& final : finals) {
      threads.emplace_back([&] { final = rollout(*backend, gain).final; });
    }
  }
  for (const Points& final : finals) EXPECT_EQ(final, first);
}

TEST_P(EveryEngine, KnowsTheErrorsOfManyGainsAtOnce) {
  const auto backend = make(plain());
  const double unit = calm_gain(backend->problem());
  const std::vector<double> gains = {0, unit, 2 * unit, 5 * unit, 9 * unit};
  const std::vector<double> errors = backend->errors(gains);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    EXPECT_EQ(errors[i], rollout(*backend, gains[i]).error.mean);
  }
}

TEST_P(EveryEngine, SpinsAFlatClothWithoutBendingIt) {
  ClothScene scene = plain();
  common(scene).gravity = 0;
  common(scene).arrival_time = 0.5;
  set_air_drag(scene, 0);
  const double stiffness = GetParam().is_sheet ? 5e3 : 2e5;
  std::visit([&](auto& any) { any.cloth.stretch_stiffness = stiffness; }, scene);
  const auto backend = make(scene);
  const Points& initial = backend->cloth().initial;
  const double rate = 4;  // rad/s in the plane of x and y
  Points velocity = Points::Zero(initial.rows(), initial.cols());
  velocity.row(1) = rate * backend->cloth().shape_of(initial).row(0);
  const auto cloth = backend->start(velocity);
  const Points none = Points::Zero(initial.rows(), initial.cols());
  for (Index n = 0; n < backend->steps(); ++n) cloth->step(none);
  const Eigen::Rotation2D<double> turn(rate * common(scene).arrival_time);
  Points expected = initial;
  expected.topRows(2) = (turn.toRotationMatrix() * backend->cloth().shape_of(initial).topRows(2));
  expected.topRows(2).colwise() += backend->cloth().mass_center(initial).head(2);
  // The scheme's own error in the phase, (rate·h)² of 2 rad at most, and centrifugal strain
  // M·rate²·L/(8·EA) of 1e-6; a sheet's, ρ·rate²·L²/(8·S), 4e-5 over 0.4 m.
  EXPECT_LT((cloth->positions() - expected).colwise().norm().maxCoeff(), 2e-4 + rounding());
}

TEST_P(EveryEngine, KeepsAngularMomentumInFreeFlight) {
  ClothScene scene = plain();
  if (auto* sheet = std::get_if<SheetScene>(&scene)) {
    // So soft that native takes no substeps: its velocity is then the leapfrog's.
    sheet->cloth.stretch_stiffness = sheet->cloth.shear_stiffness = 5;
  } else {
    scene = scene_library::family_member(4);
  }
  set_air_drag(scene, 0);
  const auto backend = make(scene);
  const Cloth& form = backend->cloth();
  const auto cloth = backend->start(launch(*backend));
  const Points none = Points::Zero(form.dimension(), form.particles());
  // About the mass centre, with each half-step velocity taken at the mean of the positions around
  // it.
  const auto spin = [&](const Points& before) {
    Points arm = Points::Zero(3, form.particles()), v = arm;
    arm.topRows(form.dimension()) = form.shape_of(0.5 * (before + cloth->positions()));
    v.topRows(form.dimension()) = form.shape_of(cloth->velocities());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Index i = 0; i < form.particles(); ++i) {
      sum += form.relative_mass[i] * arm.col(i).head<3>().cross(v.col(i).head<3>());
    }
    return sum;
  };
  Points before = cloth->positions();
  cloth->step(none);
  const Eigen::Vector3d first = spin(before);
  // Arms are of order 0.3 m and speeds of order 1 m/s.
  const double scale = 0.1 * static_cast<double>(form.particles());
  for (Index n = 1; n < backend->steps(); ++n) {
    before = cloth->positions();
    cloth->step(none);
    ASSERT_LT((spin(before) - first).norm(), scale * 30 * rounding()) << "step " << n;
  }
}

TEST_P(EveryEngine, TakesAnAbsurdGainAsAValueNotAsACrash) {
  const auto backend = make(plain());
  for (const double gain : {1e3, 1e9, 1e30, 1e300}) {
    const Rollout flight = rollout(*backend, gain);
    if (flight.status == RolloutStatus::ok) {
      EXPECT_TRUE(flight.final.allFinite());
    } else {
      EXPECT_EQ(flight.error.mean, std::numeric_limits<double>::infinity());
      EXPECT_GT(flight.diverged_at_step, 0);
      EXPECT_FALSE(flight.reason.empty());
    }
  }
}

TEST_P(EveryEngine, StartsFromEveryShapeThatItAccepts) {
  for (const ClothScene& scene : hard_starts(GetParam())) {
    try {
      const auto backend = make(scene);
      EXPECT_TRUE(rollout(*backend, 0).final.allFinite());
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("/initial"), std::string::npos);
    }
  }
}

TEST_P(EveryEngine, KeepsFramesAtTheirTimes) {
  const auto backend = make(plain());
  const Rollout flight = rollout(*backend, 0, {.frames_per_second = 24});
  ASSERT_EQ(flight.frame_times.size(), 25u);
  ASSERT_EQ(flight.frame_positions.size(), 25u);
  EXPECT_EQ(flight.frame_positions.front(), backend->cloth().initial);
  EXPECT_EQ(flight.frame_positions.back(), flight.final);
  for (std::size_t i = 0; i < 25; ++i) {
    EXPECT_NEAR(flight.frame_times[i], static_cast<double>(i) / 24, 1e-12);
  }
}

// ---- symmetries: a changed scene has the correspondingly changed answer ----------------------

/// How far rounding spreads over a calm flight: sensitivities stay below ten.
constexpr double calm_growth = 10;

TEST_P(EveryEngine, IsBlindToWhereTheSceneLies) {
  for (ClothScene& scene : calm_scenes(GetParam())) {
    const double gain = calm_gain(problem_of(scene));
    const Eigen::Vector3d offset(2, -3, 1);
    const ClothScene moved = with_shapes(
        scene, [&](const Points& x) -> Points { return x.colwise() + offset.head(x.rows()); });
    const Points plain = final_shape(scene, gain);
    const Points difference =
        (final_shape(moved, gain).colwise() - offset.head(plain.rows())) - plain;
    EXPECT_LT(difference.colwise().norm().maxCoeff(), calm_growth * rounding())
        << common(scene).name;
  }
}

TEST_P(EveryEngine, MirrorsItsAnswerWithTheScene) {
  for (ClothScene& scene : calm_scenes(GetParam())) {
    const double gain = calm_gain(problem_of(scene));
    const auto mirror = [](Points x) {
      x.row(0) *= -1;
      return x;
    };
    EXPECT_LT(
        farthest(final_shape(with_shapes(scene, mirror), gain), mirror(final_shape(scene, gain))),
        calm_growth * rounding())
        << common(scene).name;
  }
}

TEST_P(EveryEngine, TurnsItsAnswerWithTheScene) {
  for (ClothScene& scene : calm_scenes(GetParam())) {
    const double gain = calm_gain(problem_of(scene));
    // A sheet about the vertical; and anything anyhow, where there is no gravity.
    std::vector<Eigen::MatrixXd> turns;
    if (GetParam().is_sheet) {
      turns.emplace_back(Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitY()).toRotationMatrix());
      turns.emplace_back(
          Eigen::AngleAxisd(1.234, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix());
    } else {
      turns.emplace_back(Eigen::Rotation2D<double>(1.234).toRotationMatrix());
    }
    for (const Eigen::MatrixXd& turn : turns) {
      if (&turn == &turns.back()) common(scene).gravity = 0;
      const ClothScene turned =
          with_shapes(scene, [&](const Points& x) -> Points { return turn * x; });
      EXPECT_LT(farthest(final_shape(turned, gain), turn * final_shape(scene, gain)),
                calm_growth * rounding())
          << common(scene).name;
    }
  }
}

TEST_P(EveryEngine, ReversesItsAnswerWithTheOrderOfParticles) {
  for (ClothScene& scene : calm_scenes(GetParam())) {
    const double gain = calm_gain(problem_of(scene));
    ClothScene reversed =
        with_shapes(scene, [](const Points& x) -> Points { return x.rowwise().reverse(); });
    if (auto* sheet = std::get_if<SheetScene>(&reversed)) {
      for (std::vector<Index>& face : sheet->faces) {
        for (Index& corner : face) corner = sheet->initial.cols() - 1 - corner;
      }
    }
    const Points answer = final_shape(reversed, gain).rowwise().reverse();
    // Box2D sweeps its joints in order, so reversing it shows what its iterations leave undone.
    const double unsolved = GetParam().engine->sweeps_joints ? 1e-3 : 0;
    EXPECT_LT(farthest(answer, final_shape(scene, gain)), calm_growth * rounding() + unsolved)
        << common(scene).name;
  }
}

TEST_P(EveryEngine, ScalesItsAnswerWithLengthTimeAndForce) {
  constexpr Units units = {.length = 4, .time = 0.5, .force = 128};  // doubles round alike
  for (ClothScene& scene : calm_scenes(GetParam())) {
    const double gain = calm_gain(problem_of(scene));
    const ClothScene scaled =
        std::visit([&](const auto& any) -> ClothScene { return in_units(any, units); }, scene);
    const Points answer = final_shape(scaled, gain * units.gain()) / units.length;
    EXPECT_LT(farthest(answer, final_shape(scene, gain)), calm_growth * rounding())
        << common(scene).name;
  }
}

INSTANTIATE_TEST_SUITE_P(Engines, EveryEngine,
                         testing::Values(Pair{"chain_on_an_own_engine", &own_engine, false},
                                         Pair{"chain_on_native", &native_engine, false},
                                         Pair{"chain_on_box2d_weld", &box2d_weld_engine, false},
                                         Pair{"chain_on_box2d_pair", &box2d_pair_engine, false},
                                         Pair{"sheet_on_native", &native_engine, true},
                                         Pair{"sheet_on_bullet", &bullet_engine, true}),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace nuno
