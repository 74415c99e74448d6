// What is wrong is refused at the door: bad scenes, bad command lines.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "program.h"

namespace nuno {
namespace {

/// The right scene with one value put in, or taken out.
std::string with(const std::string& pointer, const Json& value) {
  Json scene = right_scene();
  scene[Json::json_pointer(pointer)] = value;
  return scene.dump();
}
std::string without(const std::string& pointer) {
  return right_scene().patch({{{"op", "remove"}, {"path", pointer}}}).dump();
}
std::string replaced(const std::string& text, const std::string& old, const std::string& fresh) {
  std::string result = text;
  return result.replace(result.find(old), old.size(), fresh);
}

// Malformed scenes

struct BadScene {
  std::string name;
  std::string text;
  std::string pointer;  ///< of the field that the message names
  std::string value;    ///< that it shows
  std::string rule;     ///< that it says was broken
};

void PrintTo(const BadScene& bad, std::ostream* out) { *out << bad.name; }

std::vector<BadScene> bad_scenes() {
  const std::string deep(200'000, '[');
  const std::string deep_closed = deep + std::string(200'000, ']');
  return {
      {"EmptyFile", "", "/", "", "not JSON"},
      {"BinaryGarbage", std::string("\x7f\0ELF\xff\xfe\x01", 8), "/", "", "not JSON"},
      {"CutOff", right_scene().dump().substr(0, 60), "/", "", "not JSON"},
      {"TrailingComma", R"({"nuno_scene": 1,})", "/", "", "not JSON"},
      {"TwoDocuments", right_scene().dump() + "{}", "/", "", "not JSON"},
      {"DeepNesting", deep, "/", "", "nested more than"},
      {"DeeplyNestedField",
       replaced(with("/nuno_scene", 1), "\"nuno_scene\":1", "\"nuno_scene\":" + deep_closed), "",
       "", ""},
      {"DeeplyNestedUnknownField",
       replaced(with("/nuno_scene", 1), "\"nuno_scene\":1", "\"x\":" + deep_closed), "", "", ""},
      {"NanToken", replaced(right_scene().dump(), "0.5", "NaN"), "/", "", "not JSON"},
      {"InfinityToken", replaced(right_scene().dump(), "0.5", "Infinity"), "/", "", "not JSON"},
      {"NumberBeyondDoubles", replaced(right_scene().dump(), "0.5", "1e999"), "/", "1e999", ""},
      {"TextThatIsNoUtf8", replaced(with("/name", "QQ"), "QQ", "\xff\xfe"), "/", "", "UTF-8"},
      {"ListInsteadOfObject", "[]", "/", "[]", "is not an object"},
      {"NumberInsteadOfObject", "3", "/", "3", "is not an object"},
      {"NullInsteadOfObject", "null", "/", "null", "is not an object"},
      {"FieldTwice", replaced(right_scene().dump(), "{", R"({"particles": 4, )"), "/particles", "",
       "twice"},
      {"FieldTwiceInside", replaced(right_scene().dump(), R"("mass":)", R"("mass":1,"mass":)"),
       "/cloth/mass", "", "twice"},
      {"NumberBelowDoubles", replaced(right_scene().dump(), "0.5", "1e-400"), "/arrival_time",
       "1e-400", "is nearer to 0 than numbers can be"},
      {"NoVersion", without("/nuno_scene"), "/nuno_scene", "", "is missing"},
      {"VersionOfTheFuture", with("/nuno_scene", 2), "/nuno_scene", "2", "is not 1"},
      {"ResultOfNothing", R"({"nuno_result": 1})", "/input", "", "is missing"},
      {"NoArrivalTime", without("/arrival_time"), "/arrival_time", "", "is missing"},
      {"ArrivalTimeOfZero", with("/arrival_time", 0), "/arrival_time", "0", "is not > 0"},
      {"ArrivalTimeInWords", with("/arrival_time", "1 s"), "/arrival_time", "\"1 s\"",
       "is not a number"},
      {"ArrivalTimeNull", with("/arrival_time", nullptr), "/arrival_time", "null",
       "is not a number"},
      {"NoInitial", without("/initial"), "/initial", "", "is missing"},
      {"NoTarget", without("/target"), "/target", "", "is missing"},
      {"TargetIsText", with("/target", "S"), "/target", "\"S\"", "is not an array of points"},
      {"OnePoint", with("/initial", {{0, 1}}), "/initial", "", "at least 2 distinct points"},
      {"NoPoints", with("/target", Json::array()), "/target", "", "at least 2 distinct points"},
      {"SamePointTwice", with("/target", {{1, 1}, {1, 1}, {1, 1}}), "/target", "",
       "at least 2 distinct points"},
      {"PointInSpace", with("/target/1", {1, 2, 3}), "/target/1", "[1,2,3]", "is not a point"},
      {"CoordinateOfText", with("/target/1/1", "up"), "/target/1/1", "\"up\"", "is not a number"},
      {"CoordinateTooLarge", with("/target/2/0", 1e308), "/target/2/0", "1e+308", "is not within"},
      {"LineThatFoldsOntoItself", with("/initial", {{0, 1}, {1, 1}, {0, 1}}), "/initial", "",
       "segment of no length"},
      {"TwoParticles", with("/particles", 2), "/particles", "2", "is not within 3"},
      {"HalfAParticle", with("/particles", 8.5), "/particles", "8.5", "is not a whole number"},
      {"TooManyParticles", with("/particles", 1'000'001), "/particles", "1000001",
       "is not within 3"},
      {"ParticlesBeyondIntegers", with("/particles", 1e300), "/particles", "1e+300",
       "is not a whole number"},
      {"ParticlesTrue", with("/particles", true), "/particles", "true", "is not a number"},
      {"NegativeGravity", with("/gravity", -9.8), "/gravity", "-9.8", "is not >= 0"},
      {"NegativeMass", with("/cloth/mass", -1), "/cloth/mass", "-1", "is not > 0"},
      {"MassOfZero", with("/cloth/mass", 0), "/cloth/mass", "0", "is not > 0"},
      {"MassBelowAnyCloth", with("/cloth/mass", 5e-324), "/cloth/mass", "5e-324", "is not within"},
      {"NegativeDrag", with("/cloth/air_drag", -0.1), "/cloth/air_drag", "-0.1", "is not >= 0"},
      {"DragLikeStone", with("/cloth/air_drag", 1e9), "/cloth/air_drag", "1000000000", "<= 700"},
      {"NoStretchStiffness", with("/cloth/stretch_stiffness", 0), "/cloth/stretch_stiffness", "0",
       "is not > 0"},
      {"NegativeStretchDamping", with("/cloth/stretch_damping", -1), "/cloth/stretch_damping", "-1",
       "is not >= 0"},
      {"NegativeHingeStiffness", with("/cloth/hinge_stiffness", -1), "/cloth/hinge_stiffness", "-1",
       "is not >= 0"},
      {"NegativeHingeDamping", with("/cloth/hinge_damping", -1), "/cloth/hinge_damping", "-1",
       "is not >= 0"},
      {"ClothIsAList", with("/cloth", Json::array()), "/cloth", "[]", "is not an object"},
      {"UnknownLaunch", with("/launch", "rocket"), "/launch", "\"rocket\"", "ballistic"},
      {"LaunchIsANumber", with("/launch", 1), "/launch", "1", "ballistic"},
      {"UnknownTargetLength", with("/target_length", "stretch"), "/target_length", "\"stretch\"",
       "as-drawn"},
      {"TimeStepOfZero", with("/time_step", 0), "/time_step", "0", "is not > 0"},
      {"TimeStepThatTakesDays", with("/time_step", 1e-12), "/time_step", "1e-12", "is not >= "},
      {"NoFrames", with("/frames_per_second", 0), "/frames_per_second", "0", "is not > 0"},
      {"MoreFramesThanMemory", with("/frames_per_second", 1e12), "/frames_per_second",
       "1000000000000", "is not <= "},
      {"NameIsANumber", with("/name", 5), "/name", "5", "is not a string"},
      {"MisspelledField", with("/partcles", 8), "/partcles", "\"partcles\"",
       "the nearest is \"particles\""},
      {"MisspelledClothField", with("/cloth/masss", 8), "/cloth/masss", "\"masss\"",
       "the nearest is \"mass\""},
      {"FieldNameOfSeveralLines", with("/a\nb", 8), "/a\\nb", "\"a\\nb\"", "is not a known field"},
  };
}

class MalformedScene : public Program, public testing::WithParamInterface<BadScene> {};

TEST_P(MalformedScene, IsRefusedInOneLineThatSaysWhereAndWhyAndTouchesNoOutput) {
  const BadScene& bad = GetParam();
  const std::string file = in_folder("bad.json").string();
  write_text(file, bad.text);
  write_text(output("result.json"), "precious");

  const Outcome run = nuno({"simulate", file, "--out", output("result.json")});
  expect_refusal(run, file + ": " + bad.pointer + (bad.pointer.empty() ? "" : ": "), bad.value,
                 bad.rule);
  EXPECT_EQ(read_text(output("result.json")), "precious");
  EXPECT_EQ(outputs(), std::set<std::string>{"result.json"});
}

INSTANTIATE_TEST_SUITE_P(EachOf, MalformedScene, testing::ValuesIn(bad_scenes()),
                         [](const auto& bad) { return bad.param.name; });

// Malformed command lines

struct BadCommand {
  std::string name;
  std::vector<std::string> arguments;
  std::string message;
};

void PrintTo(const BadCommand& bad, std::ostream* out) { *out << bad.name; }

std::vector<BadCommand> bad_commands() {
  const std::string s = scene("s-curve-32");
  return {
      {"NoCommand", {}, "nuno: a command is missing; see nuno --help"},
      {"UnknownCommand",
       {"simulat"},
       "nuno: \"simulat\" is not one of simulate, optimize, throw, compare, batch, studio, "
       "figures, render"},
      {"UnknownGlobalOption", {"--bogus"}, "--bogus: is not a known option"},
      {"NoScene", {"simulate"}, "SCENE: is missing; it is required"},
      {"NoSceneToCompare", {"compare"}, "SCENE: is missing; it is required"},
      {"EmptyScene", {"simulate", ""}, "SCENE: \"\" is not a name"},
      {"SecondScene", {"simulate", s, "b.json"}, "\"b.json\": is one argument too many"},
      {"SecondCommand", {"simulate", s, "optimize", s}, "\"optimize\": is one argument too many"},
      {"UnknownOption", {"simulate", s, "--speed", "1"}, "--speed: is not a known option"},
      {"OptionOfAnotherCommand", {"optimize", s, "--alpha=1"}, "--alpha=1: is not a known option"},
      {"NegativeGain", {"simulate", s, "--alpha", "-1"}, "--alpha: -1 is not >= 0"},
      {"NegativeGainGlued", {"simulate", s, "--alpha=-1"}, "--alpha: -1 is not >= 0"},
      {"GainIsNan", {"simulate", s, "--alpha", "nan"}, "--alpha: \"nan\" is not a finite number"},
      {"GainIsInfinite",
       {"simulate", s, "--alpha", "inf"},
       "--alpha: \"inf\" is not a finite number"},
      {"GainBeyondDoubles",
       {"simulate", s, "--alpha", "1e999"},
       "--alpha: \"1e999\" is not a finite number"},
      {"GainInWords",
       {"simulate", s, "--alpha", "much"},
       "--alpha: \"much\" is not a finite number"},
      {"GainWithUnit",
       {"simulate", s, "--alpha", "1N/m"},
       "--alpha: \"1N/m\" is not a finite number"},
      {"GainEmpty", {"simulate", s, "--alpha", ""}, "--alpha: \"\" is not a finite number"},
      {"GainMissing", {"simulate", s, "--alpha"}, "--alpha: takes exactly one value"},
      {"GainTwice",
       {"simulate", s, "--alpha", "1", "--alpha", "2"},
       "--alpha: takes exactly one value"},
      {"TimeStepOfZero", {"simulate", s, "--time-step", "0"}, "--time-step: 0 is not > 0"},
      {"TimeStepNegative",
       {"optimize", s, "--time-step", "-0.001"},
       "--time-step: -0.001 is not > 0"},
      {"UnknownBackend",
       {"simulate", s, "--backend", "havok"},
       "--backend: \"havok\" is not one of native, box2d, bullet"},
      {"UnknownOptimizer",
       {"optimize", s, "--optimizer", "newton"},
       "--optimizer: \"newton\" is not one of global, steepest-descent"},
      {"NegativeErrorLimit",
       {"optimize", s, "--error-limit", "-0.1"},
       "--error-limit: -0.1 is not >= 0"},
      {"EffortLimitInWords",
       {"optimize", s, "--effort-limit", "little"},
       "--effort-limit: \"little\" is not a finite number"},
      {"BothLimits",
       {"optimize", s, "--error-limit", "1", "--effort-limit", "1"},
       "--effort-limit: does not go with --error-limit"},
      {"RobustWithALimit",
       {"optimize", s, "--robust", "--error-limit", "1"},
       "--robust: does not go with a limit"},
      {"OneGainOfSeveralNegative", {"simulate", s, "--alpha", "1,-2,3"}, "--alpha: -2 is not >= 0"},
      {"OneGainOfSeveralMissing",
       {"simulate", s, "--alpha", "1,,3"},
       "--alpha: \"\" is not a finite number"},
      {"GainAfterTheLastComma",
       {"simulate", s, "--alpha", "1,"},
       "--alpha: \"\" is not a finite number"},
      {"TooManyGains",
       {"simulate", s, "--alpha", "1,2,3,4,5"},
       "--alpha: \"1,2,3,4,5\" is more than 4 gains"},
      {"NoCoefficients",
       {"optimize", s, "--coefficients", "0"},
       "--coefficients: 0 is not a whole number within 1 … 4"},
      {"TooManyCoefficients",
       {"optimize", s, "--coefficients", "5"},
       "--coefficients: 5 is not a whole number within 1 … 4"},
      {"HalfACoefficient",
       {"optimize", s, "--coefficients", "1.5"},
       "--coefficients: 1.5 is not a whole number within 1 … 4"},
      {"CoefficientsInWords",
       {"optimize", s, "--coefficients", "two"},
       "--coefficients: \"two\" is not a finite number"},
      {"CoefficientsWithALimit",
       {"optimize", s, "--coefficients", "2", "--effort-limit", "1"},
       "--coefficients: does not go with --robust or a limit"},
      {"CoefficientsRobust",
       {"optimize", s, "--coefficients", "2", "--robust"},
       "--coefficients: does not go with --robust or a limit"},
      {"OptimizerWithALimit",
       {"optimize", s, "--optimizer", "global", "--error-limit", "0.1"},
       "--optimizer: does not go with a limit"},
      {"RefineWithCoefficients",
       {"optimize", s, "--refine", "--coefficients", "2"},
       "--refine: does not go with --coefficients or --robust, it has a gain of its own"},
      {"RefineWithRobust",
       {"optimize", s, "--refine", "--robust"},
       "--refine: does not go with --coefficients or --robust, it has a gain of its own"},
      {"FlagWithAValue", {"optimize", s, "--refine=x"}, "--refine: takes no value"},
      {"FlagTurnedOff", {"render", s, "--still=false"}, "--still: takes no value"},
      {"FlagTurnedOn", {"optimize", s, "--refine=true"}, "--refine: takes no value"},
      {"FlagWithAnEmptyValue", {"optimize", s, "--robust="}, "--robust: takes no value"},
      {"HelpWithAValue", {"optimize", "-h=x"}, "-h: takes no value"},
      {"VersionWithAValue", {"--version=x"}, "--version: takes no value"},
      {"EmptyOutput", {"simulate", s, "--out", ""}, "--out: \"\" is not a name"},
      {"OutputMissing", {"compare", s, "--out"}, "--out: takes exactly one value"},
      {"NewlineInAnOption",
       {"simulate", s, "--backend", "a\nb"},
       "--backend: \"a b\" is not one of native, box2d, bullet"},
  };
}

class MalformedCommandLine : public Program, public testing::WithParamInterface<BadCommand> {};

TEST_P(MalformedCommandLine, IsRefusedInOneLine) {
  const Outcome run = nuno(GetParam().arguments);
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(run.err, GetParam().message + "\n");
}

INSTANTIATE_TEST_SUITE_P(EachOf, MalformedCommandLine, testing::ValuesIn(bad_commands()),
                         [](const auto& bad) { return bad.param.name; });

class Refusal : public Program {};

TEST_F(Refusal, OfAWrongOptionLeavesTheOutputAlone) {
  write_text(output("result.json"), "precious");
  const Outcome run =
      nuno({"simulate", scene("s-curve-32"), "--out", output("result.json"), "--alpha", "-1"});
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(read_text(output("result.json")), "precious");
}

TEST_F(Refusal, OfMoreCoefficientsThanTheClothHasModesNamesTheField) {
  const std::string file = in_folder("small.json").string();  // of 8 particles
  write_text(file, right_scene().dump());
  const std::string message =
      file + ": /particles: 8 is not >= 13, the fewest for 4 coefficients\n";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"optimize", file, "--coefficients", "4"},
        {"simulate", file, "--alpha", "1,1,1,1"}}) {
    const Outcome run = nuno(arguments);
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.err, message);
  }
  EXPECT_EQ(nuno({"simulate", file, "--alpha", "1,1,1"}).status, 0);
}

TEST_F(Refusal, OfASceneThatIsNotThereNamesTheFile) {
  const Outcome run = nuno({"simulate", "no-such.json"});
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(is_one_line(run.err) && run.err.starts_with("no-such.json: cannot")) << run.err;
}

TEST_F(Refusal, OfAFolderInPlaceOfASceneNamesIt) {
  const Outcome run = nuno({"optimize", in_folder("outputs")});
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(is_one_line(run.err) && run.err.starts_with(in_folder("outputs").string()))
      << run.err;
}

TEST_F(Refusal, OfAnEmptyFolderOfScenesNamesIt) {
  const Outcome run = nuno({"compare", in_folder("outputs")});
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(is_one_line(run.err) && run.err.starts_with(in_folder("outputs").string()))
      << run.err;
}

TEST_F(Refusal, OfTheLastSceneComesBeforeTheFirstIsCompared) {
  write_text(in_folder("bad.json"), with("/cloth/mass", -1));
  const Outcome run =
      nuno({"compare", scene("s-curve-32"), in_folder("bad.json"), "--out", output("comparison")});
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_TRUE(is_one_line(run.err)) << run.err;
  EXPECT_TRUE(outputs().empty()) << "not even the folder is made";
}

TEST_F(Refusal, OfAStepOutOfRangeNamesTheOption) {
  const Outcome run = nuno({"simulate", scene("s-curve-32"), "--time-step", "1e-300"});
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(is_one_line(run.err) && run.err.starts_with("--time-step: ")) << run.err;
}

TEST_F(Refusal, OfAGainThatNoStepResolvesNamesTheOption) {
  const Outcome run = nuno({"simulate", scene("s-curve-32"), "--alpha", "1e300"});
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(is_one_line(run.err) && run.err.starts_with("--alpha: 1e+300 is not <= ")) << run.err;
}

}  // namespace
}  // namespace nuno
