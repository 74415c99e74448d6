// Every field of a scene file is read, written and checked.

#include <nuno/problem.h>
#include <nuno/scene_file.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "temporary_folder.h"

namespace nuno {
namespace {

using Json = nlohmann::json;

/// A chain's scene with a value in every field, none of them the default.
Json chain_with_every_field() {
  return {{"nuno_scene", 1},
          {"name", "every"},
          {"particles", 5},
          {"arrival_time", 0.7},
          {"gravity", 1.5},
          {"initial", {{0.25, 1.0}, {1.5, 1.125}}},
          {"target", {{3.0, 1.0}, {3.0, 1.5}, {2.75, 3.0}}},
          {"cloth",
           {{"mass", 0.2},
            {"air_drag", 0.01},
            {"stretch_stiffness", 321.0},
            {"stretch_damping", 7e-4},
            {"hinge_stiffness", 2e-3},
            {"hinge_damping", 1e-7}}},
          {"launch", "inextensible"},
          {"reference", "morph"},
          {"arrival", "settle"},
          {"damping_ratio", 0.35},
          {"target_length", "as-drawn"},
          {"target_order", "reversed"},
          {"time_step", 0.0015},
          {"frames_per_second", 24.0}};
}

/// The same without one field, which a pointer names.
Json without(const Json& json, const std::string& pointer) {
  return json.patch({{{"op", "remove"}, {"path", pointer}}});
}

/// Those of chain_with_every_field, and of the sheet's, that do not ask what the cloth is.
void expect_fields_of_any_cloth(const Scene& scene) {
  EXPECT_EQ(scene.launch, Launch::inextensible);
  EXPECT_EQ(scene.reference, Reference::morph);
  EXPECT_EQ(scene.arrival, Arrival::settle);
  EXPECT_EQ(scene.damping_ratio, 0.35);
  EXPECT_EQ(scene.target_length, TargetLength::as_drawn);
  EXPECT_EQ(scene.time_step, 0.0015);
  EXPECT_EQ(scene.frames_per_second, 24);
}

TEST(ChainFields, AreAllRead) {
  const ChainScene scene = parse_scene(chain_with_every_field().dump(), "file.json");
  EXPECT_EQ(scene.name, "every");
  EXPECT_EQ(scene.particles, 5);
  EXPECT_EQ(scene.arrival_time, 0.7);
  EXPECT_EQ(scene.gravity, 1.5);
  EXPECT_EQ(scene.initial, (Points{{0.25, 1.5}, {1.0, 1.125}}));
  EXPECT_EQ(scene.target, (Points{{3.0, 3.0, 2.75}, {1.0, 1.5, 3.0}}));
  EXPECT_EQ(scene.cloth.mass, 0.2);
  EXPECT_EQ(scene.cloth.air_drag, 0.01);
  EXPECT_EQ(scene.cloth.stretch_stiffness, 321);
  EXPECT_EQ(scene.cloth.stretch_damping, 7e-4);
  EXPECT_EQ(scene.cloth.hinge_stiffness, 2e-3);
  EXPECT_EQ(scene.cloth.hinge_damping, 1e-7);
  EXPECT_EQ(scene.target_order, TargetOrder::reversed);
  expect_fields_of_any_cloth(scene);
}

TEST(ChainFields, AreAllWritten) {
  const Json every = chain_with_every_field();
  EXPECT_EQ(Json::parse(to_json(parse_scene(every.dump(), "file.json"))), every);
}

TEST(ChainFields, AreWrittenWhereTheyAreTheDefaultToo) {
  Json every = chain_with_every_field();
  every["launch"] = "ballistic";
  every["reference"] = "hold";
  every["arrival"] = "pass";
  every["damping_ratio"] = 0.0;
  every["target_length"] = "fit";
  every["target_order"] = "as-drawn";
  EXPECT_EQ(Json::parse(to_json(parse_scene(every.dump(), "file.json"))), every);
}

TEST(ChainFields, ReachTheProblem) {
  const ChainScene scene = parse_scene(chain_with_every_field().dump(), "file.json");
  const Problem problem = make_problem(scene);
  EXPECT_EQ(problem.arrival_time, 0.7);
  EXPECT_EQ(problem.launch, Launch::inextensible);
  EXPECT_EQ(problem.reference, Reference::morph);
  EXPECT_EQ(problem.arrival, Arrival::settle);
  EXPECT_EQ(problem.damping_ratio, 0.35);
  EXPECT_EQ(problem.target_scale, 1);
  EXPECT_EQ(problem.target.col(0), scene.target.col(2)) << "reversed";
  EXPECT_EQ(problem.target.col(4), scene.target.col(0));
  EXPECT_EQ(problem.time_step, 0.0015);
  EXPECT_EQ(problem.cloth().particles(), 5);
  EXPECT_EQ(problem.cloth().gravity, 1.5);
  EXPECT_DOUBLE_EQ(problem.cloth().particle_mass, 0.2 / 5);
  EXPECT_DOUBLE_EQ(problem.cloth().drag_rate, 0.01 / 0.2);
  EXPECT_EQ(problem.chain().material.hinge_damping, 1e-7);
  EXPECT_FALSE(with_time_step(problem, std::nullopt).time_step);
  EXPECT_EQ(with_time_step(problem, 0.1).time_step, 0.1);
}

/// A number of a scene file, and whether it may be zero.
struct Number {
  const char* pointer;
  bool may_be_zero;
};

void PrintTo(const Number& number, std::ostream* out) { *out << number.pointer; }

constexpr Number chain_numbers[] = {{"/arrival_time", false},
                                    {"/gravity", true},
                                    {"/cloth/mass", false},
                                    {"/cloth/air_drag", true},
                                    {"/cloth/stretch_stiffness", false},
                                    {"/cloth/stretch_damping", true},
                                    {"/cloth/hinge_stiffness", true},
                                    {"/cloth/hinge_damping", true},
                                    {"/damping_ratio", true},
                                    {"/time_step", false},
                                    {"/frames_per_second", false}};

/// What is said of a scene; empty if it is taken.
std::string complaint(const Json& json) {
  try {
    parse_scene(json.dump(), "file.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

class ChainNumber : public testing::TestWithParam<Number> {};

TEST_P(ChainNumber, IsWithinItsRange) {
  const std::string pointer = GetParam().pointer;
  Json json = chain_with_every_field();
  EXPECT_EQ(complaint(json), "");
  const auto with = [&](const Json& value) {
    json[Json::json_pointer(pointer)] = value;
    return complaint(json);
  };
  const std::string rule = GetParam().may_be_zero ? "is not >= 0" : "is not > 0";
  EXPECT_EQ(with(-1), "file.json: " + pointer + ": -1 " + rule);
  EXPECT_EQ(with(-1e-9), "file.json: " + pointer + ": -1e-09 " + rule);
  EXPECT_EQ(with(0), GetParam().may_be_zero ? "" : "file.json: " + pointer + ": 0 " + rule);
  EXPECT_EQ(with(2e12).find("file.json: " + pointer + ": 2000000000000 is not"), 0u) << with(2e12);
  EXPECT_EQ(with("1"), "file.json: " + pointer + ": \"1\" is not a number");
}

INSTANTIATE_TEST_SUITE_P(EachOf, ChainNumber, testing::ValuesIn(chain_numbers));

TEST(ChainFields, ThatAreWordsAreRefusedByName) {
  for (const auto& [field, words] : {std::pair{"launch", "\"ballistic\" or \"inextensible\""},
                                     {"reference", "\"hold\" or \"morph\""},
                                     {"arrival", "\"pass\" or \"settle\""},
                                     {"target_length", "\"fit\" or \"as-drawn\""}}) {
    Json json = chain_with_every_field();
    json[field] = "other";
    EXPECT_EQ(complaint(json), std::string("file.json: /") + field + ": \"other\" is not " + words);
  }
}

// A scene that a program makes is checked by the same rules.
TEST(ChainFields, OfAProgramsSceneMustBeNumbers) {
  const ChainScene right = parse_scene(chain_with_every_field().dump(), "file.json");
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.0}) {
    ChainScene scene = right;
    scene.damping_ratio = bad;
    EXPECT_THROW(make_problem(scene), InputError) << bad;
    scene = right;
    scene.cloth.hinge_stiffness = bad;
    EXPECT_THROW(make_problem(scene), InputError) << bad;
    scene = right;
    scene.time_step = bad;
    EXPECT_THROW(make_problem(scene), InputError) << bad;
  }
}

class SheetFields : public testing::Test {
 protected:
  SheetFields() {
    std::ofstream(path("start.obj")) << "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nv 2 0 0\nv 2 0 1\n"
                                        "f 1 2 3 4\nf 4 3 6 5\n";
    std::ofstream(path("target.obj")) << "v 0 3 0\nv 0 3 1\nv 1 4 1\nv 1 4 0\nv 2 3 0\nv 2 3 1\n"
                                         "f 1 2 3 4\nf 4 3 6 5\n";
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  SheetScene read(const Json& json) const {
    std::ofstream(path("scene.json")) << json.dump();
    return std::get<SheetInput>(read_scene(path("scene.json"))).scene;
  }

  const Json every = {{"nuno_scene", 1},
                      {"name", "every"},
                      {"arrival_time", 0.7},
                      {"gravity", 1.5},
                      {"initial", "start.obj"},
                      {"target", "target.obj"},
                      {"cloth",
                       {{"areal_density", 0.2},
                        {"air_drag", 0.01},
                        {"stretch_stiffness", 321.0},
                        {"stretch_damping", 7e-4},
                        {"shear_stiffness", 12.0},
                        {"shear_damping", 3e-4},
                        {"bending_stiffness", 2e-5},
                        {"bending_damping", 1e-7}}},
                      {"rest", "flat"},
                      {"launch", "inextensible"},
                      {"reference", "morph"},
                      {"arrival", "settle"},
                      {"damping_ratio", 0.35},
                      {"target_length", "as-drawn"},
                      {"time_step", 0.0015},
                      {"frames_per_second", 24.0}};

 private:
  TemporaryFolder folder_;
};

TEST_F(SheetFields, AreAllRead) {
  const SheetScene scene = read(every);
  EXPECT_EQ(scene.name, "every");
  EXPECT_EQ(scene.arrival_time, 0.7);
  EXPECT_EQ(scene.gravity, 1.5);
  EXPECT_EQ(scene.initial.col(4), Eigen::Vector3d(2, 0, 0));
  EXPECT_EQ(scene.target.col(2), Eigen::Vector3d(1, 4, 1));
  EXPECT_EQ(scene.faces, (Faces{{0, 1, 2, 3}, {3, 2, 5, 4}}));
  EXPECT_EQ(scene.cloth.areal_density, 0.2);
  EXPECT_EQ(scene.cloth.air_drag, 0.01);
  EXPECT_EQ(scene.cloth.stretch_stiffness, 321);
  EXPECT_EQ(scene.cloth.stretch_damping, 7e-4);
  EXPECT_EQ(scene.cloth.shear_stiffness, 12);
  EXPECT_EQ(scene.cloth.shear_damping, 3e-4);
  EXPECT_EQ(scene.cloth.bending_stiffness, 2e-5);
  EXPECT_EQ(scene.cloth.bending_damping, 1e-7);
  EXPECT_EQ(scene.rest, Rest::flat);
  expect_fields_of_any_cloth(scene);
}

TEST_F(SheetFields, HaveTheirDefaultsWhereTheyAreLeftOut) {
  const SheetScene defaults;
  for (const char* field : {"gravity", "rest", "launch", "reference", "arrival", "damping_ratio",
                            "target_length", "time_step", "frames_per_second"}) {
    EXPECT_NO_THROW(read(without(every, std::string("/") + field))) << field;
  }
  const SheetScene scene = read(
      {{"nuno_scene", 1}, {"arrival_time", 1}, {"initial", "start.obj"}, {"target", "target.obj"}});
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.gravity, defaults.gravity);
  EXPECT_EQ(scene.rest, Rest::initial);
  EXPECT_EQ(scene.reference, Reference::hold);
  EXPECT_EQ(scene.cloth.stretch_stiffness, defaults.cloth.stretch_stiffness);
  EXPECT_EQ(scene.cloth.bending_stiffness, defaults.cloth.bending_stiffness);
}

TEST_F(SheetFields, OfClothTakeThePlaceOfTheNamedMaterials) {
  Json json = without(every, "/cloth");
  json["material"] = "denim";
  const SheetMaterial named = read(json).cloth;
  EXPECT_NE(named.areal_density, SheetMaterial().areal_density);
  json["cloth"] = {{"bending_stiffness", 5e-3}};
  const SheetMaterial changed = read(json).cloth;
  EXPECT_EQ(changed.bending_stiffness, 5e-3);
  EXPECT_EQ(changed.areal_density, named.areal_density);
  EXPECT_EQ(changed.stretch_stiffness, named.stretch_stiffness);
  json["material"] = "lead";
  EXPECT_THROW(read(json), InputError);
}

TEST_F(SheetFields, ThatAreNumbersAreWithinTheirRanges) {
  for (const Number& number : {Number{"/arrival_time", false},
                               {"/gravity", true},
                               {"/cloth/areal_density", false},
                               {"/cloth/air_drag", true},
                               {"/cloth/stretch_stiffness", false},
                               {"/cloth/stretch_damping", true},
                               {"/cloth/shear_stiffness", true},
                               {"/cloth/shear_damping", true},
                               {"/cloth/bending_stiffness", true},
                               {"/cloth/bending_damping", true},
                               {"/damping_ratio", true},
                               {"/time_step", false},
                               {"/frames_per_second", false}}) {
    const auto with = [&](double value) -> std::string {
      Json json = every;
      json[Json::json_pointer(number.pointer)] = value;
      try {
        read(json);
      } catch (const InputError& error) {
        return error.what();
      }
      return "";
    };
    const std::string rule = number.may_be_zero ? "is not >= 0" : "is not > 0";
    EXPECT_EQ(with(-1), path("scene.json") + ": " + number.pointer + ": -1 " + rule);
    EXPECT_EQ(with(0).empty(), number.may_be_zero) << number.pointer;
    EXPECT_NE(with(2e12), "") << number.pointer;
  }
}

}  // namespace
}  // namespace nuno
