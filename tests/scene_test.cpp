#include <nuno/problem.h>
#include <nuno/scene.h>
#include <nuno/scene_file.h>

#include <gtest/gtest.h>

namespace nuno {
namespace {

const std::string smallest = R"({"nuno_scene": 1, "arrival_time": 1.5,
  "initial": [[0, 1], [1, 1]], "target": [[3, 1], [3, 1.5], [3, 3]]})";

TEST(Scene, LeavesOutWhatHasADefault) {
  const ChainScene scene = parse_scene(smallest, "folder/wave.json");
  EXPECT_EQ(scene.name, "wave");
  EXPECT_EQ(scene.particles, 32);
  EXPECT_EQ(scene.arrival_time, 1.5);
  EXPECT_EQ(scene.gravity, 9.80665);
  EXPECT_EQ(scene.cloth.mass, 0.1);
  EXPECT_EQ(scene.cloth.air_drag, 0.05);
  EXPECT_EQ(scene.cloth.stretch_stiffness, 200);
  EXPECT_EQ(scene.cloth.stretch_damping, 6e-4);
  EXPECT_EQ(scene.cloth.hinge_stiffness, 1e-3);
  EXPECT_EQ(scene.cloth.hinge_damping, 0);
  EXPECT_EQ(scene.launch, Launch::ballistic);
  EXPECT_EQ(scene.target_length, TargetLength::fit);
  EXPECT_FALSE(scene.time_step);
  EXPECT_EQ(scene.frames_per_second, 60);
}

TEST(Scene, ReadsBackExactlyWhatItWrites) {
  ChainScene scene = parse_scene(smallest, "wave");
  scene.particles = 47;
  scene.arrival_time = 0.1 + 0.2;
  scene.gravity = 1.0 / 3;
  scene.initial(0, 0) = -1e-17;
  scene.cloth = {0.123456789012345678, 1e-9, 20'000.1, 0, 1.7e-5, 3.3e-7};
  scene.launch = Launch::inextensible;
  scene.target_length = TargetLength::as_drawn;
  scene.time_step = 1.0 / 1024 / 3;
  scene.frames_per_second = 23.976;
  const std::string text = to_json(scene);
  const ChainScene again = parse_scene(text, "other");
  EXPECT_EQ(to_json(again), text);
  EXPECT_EQ(again.arrival_time, scene.arrival_time);
  EXPECT_EQ(again.initial, scene.initial);
  EXPECT_EQ(again.cloth.mass, scene.cloth.mass);
  EXPECT_EQ(again.launch, scene.launch);
  EXPECT_EQ(again.target_length, scene.target_length);
  EXPECT_EQ(again.time_step, scene.time_step);
}

struct BadScene {
  std::string from, to;  ///< what replaces what in the smallest scene
  std::string message;
};

class MalformedScene : public testing::TestWithParam<BadScene> {};

TEST_P(MalformedScene, IsRefusedWithFieldValueAndRule) {
  std::string text = smallest;
  text.replace(text.find(GetParam().from), GetParam().from.size(), GetParam().to);
  try {
    parse_scene(text, "bad.json");
    FAIL() << "accepted: " << text;
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), "bad.json: " + GetParam().message);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fields, MalformedScene,
    testing::Values(
        BadScene{R"("nuno_scene": 1, )", "", "/nuno_scene: is missing; it is required"},
        BadScene{R"("nuno_scene": 1)", R"("nuno_scene": 2)", "/nuno_scene: 2 is not 1"},
        BadScene{R"("arrival_time": 1.5,)", "", "/arrival_time: is missing; it is required"},
        BadScene{"1.5,", "0,", "/arrival_time: 0 is not > 0"},
        BadScene{"1.5,", "\"soon\",", "/arrival_time: \"soon\" is not a number"},
        BadScene{"1.5,", "1.5, \"particles\": 2,", "/particles: 2 is not within 3 … 1000000"},
        BadScene{"1.5,", "1.5, \"particles\": 3.5,", "/particles: 3.5 is not a whole number"},
        BadScene{"1.5,", "1.5, \"gravity\": -1,", "/gravity: -1 is not >= 0"},
        BadScene{"1.5,", "1.5, \"cloth\": {\"mass\": -1},", "/cloth/mass: -1 is not > 0"},
        BadScene{"1.5,", "1.5, \"cloth\": {\"mas\": 1},",
                 "/cloth/mas: \"mas\" is not a known field; the nearest is \"mass\""},
        BadScene{"1.5,", "1.5, \"particle\": 9,",
                 "/particle: \"particle\" is not a known field; the nearest is \"particles\""},
        BadScene{"1.5,", "1.5, \"cloth\": 3,", "/cloth: 3 is not an object"},
        BadScene{"1.5,", "1.5, \"launch\": \"bouncy\",",
                 "/launch: \"bouncy\" is not \"ballistic\" or \"inextensible\""},
        BadScene{"1.5,", "1.5, \"arrival_time\": 2,", "/arrival_time: stands twice in one object"},
        BadScene{"1.5,", R"(1.5, "cloth": {"mass": 1, "mass": 2},)",
                 "/cloth/mass: stands twice in one object"},
        BadScene{"1.5,", R"(1.5, "cloth": {"mass": 1e-400},)",
                 "/cloth/mass: 1e-400 is nearer to 0 than numbers can be"},
        BadScene{"[[0, 1], [1, 1]]", "[[0, 1]]",
                 "/initial: 1 point(s) are not at least 2 distinct points"},
        BadScene{"[[0, 1], [1, 1]]", "[[0, 1], [0, 1]]",
                 "/initial: all points are the same, not at least 2 distinct points"},
        BadScene{"[[0, 1], [1, 1]]", "[[0, 1], [1]]", "/initial/1: [1] is not a point [x, y]"},
        BadScene{"[[0, 1], [1, 1]]", "[[0, 1], [1, null]]", "/initial/1/1: null is not a number"},
        BadScene{"[[0, 1], [1, 1]]", "[[0, 1], [1, 1e300]]",
                 "/initial/1/1: 1e+300 is not within ±1000000000000"}));

TEST(Scene, RefusesWhatIsNoJsonInOneLine) {
  for (const std::string text : {"", "{", "[1,\n2", "\x01\xff", "{\"a\": 1e999}", "nul"}) {
    try {
      parse_scene(text, "bad.json");
      FAIL() << "accepted: " << text;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos);
      EXPECT_EQ(message.rfind("bad.json: /: ", 0), 0u) << message;
    }
  }
}

TEST(Problem, FitsTheTargetToTheClothAboutItsCentroid) {
  const ChainScene scene = parse_scene(smallest, "wave");
  const Problem problem = make_problem(scene);
  EXPECT_DOUBLE_EQ(problem.chain().size, 1);
  EXPECT_DOUBLE_EQ(problem.target_scale, 0.5);
  EXPECT_NEAR(segment_lengths(problem.target).sum(), 1, 1e-15);
  EXPECT_LT((centroid(problem.target) - Eigen::Vector2d(3, 2)).norm(), 1e-15);
}

TEST(Problem, LeavesATargetAsDrawnOnRequest) {
  ChainScene scene = parse_scene(smallest, "wave");
  scene.target_length = TargetLength::as_drawn;
  const Problem problem = make_problem(scene);
  EXPECT_EQ(problem.target_scale, 1);
  EXPECT_NEAR(segment_lengths(problem.target).sum(), 2, 1e-15);
}

TEST(Problem, SharesTheClothAmongItsParticles) {
  ChainScene scene = parse_scene(smallest, "wave");
  scene.particles = 50;
  const Problem problem = make_problem(scene);
  EXPECT_DOUBLE_EQ(problem.chain().particle_mass, scene.cloth.mass / 50);
  EXPECT_DOUBLE_EQ(problem.chain().particle_mass * problem.chain().drag_rate,
                   scene.cloth.air_drag / 50);
  EXPECT_EQ(problem.chain().rest_length.size(), 49);
  EXPECT_EQ(problem.chain().hinge_length.size(), 48);
}

TEST(Problem, RefusesADrawingThatFoldsTwoNeighboursOntoOneSpot) {
  ChainScene scene = parse_scene(smallest, "wave");
  scene.particles = 4;  // thirds of a line that runs there and back: particles 1 and 2 coincide
  scene.initial = Points{{0.0, 1.0, 0.0}, {0.0, 0.0, 0.0}};
  EXPECT_THROW(make_problem(scene), InputError);
}

}  // namespace
}  // namespace nuno
