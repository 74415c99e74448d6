// The program as a script sees it: exit status, standard output, standard error, files.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using namespace std::chrono_literals;

const fs::path scenes = NUNO_SCENES;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

Json read_json(const fs::path& path) { return Json::parse(read_text(path)); }

/// A run of the program that has ended.
struct Outcome {
  int status = -1;  ///< exit status, or minus the signal that killed it
  std::string out, err;
};

/// A run of the program, its output in two files; `out` may also be a device.
class Process {
 public:
  Process(const std::vector<std::string>& arguments, const fs::path& out, const fs::path& err) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    std::vector<std::string> words = arguments;
    words.insert(words.begin(), NUNO_PROGRAM);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if (posix_spawn(&id_, NUNO_PROGRAM, &actions, nullptr, argv.data(), environ) != 0) {
      throw std::runtime_error("cannot start " NUNO_PROGRAM);
    }
    posix_spawn_file_actions_destroy(&actions);
  }

  void send(int signal) const { kill(id_, signal); }

  /// Exit status, or minus the signal. A program that hangs is killed after two minutes.
  int wait() const {
    const auto deadline = std::chrono::steady_clock::now() + 120s;
    int status = 0;
    while (waitpid(id_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > deadline) kill(id_, SIGKILL);
      std::this_thread::sleep_for(1ms);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t id_ = 0;
};

/// A folder of its own for every test.
class Program : public testing::Test {
 protected:
  Program() {
    std::string pattern = (fs::temp_directory_path() / "nuno-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    fs::create_directory(folder_ / "outputs");
  }
  ~Program() override { fs::remove_all(folder_); }

  fs::path in_folder(const std::string& name) const { return folder_ / name; }

  /// A place for an output: nothing else is in its folder.
  fs::path output(const std::string& name) const { return folder_ / "outputs" / name; }

  std::set<std::string> outputs() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / "outputs")) {
      names.insert(entry.path().filename());
    }
    return names;
  }

  Outcome nuno(const std::vector<std::string>& arguments) const {
    const fs::path out = folder_ / "stdout", err = folder_ / "stderr";
    Outcome run;
    run.status = Process(arguments, out, err).wait();
    run.out = read_text(out);
    run.err = read_text(err);
    return run;
  }

  Json simulated(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--out", "-"});
    const Outcome run = nuno(arguments);
    EXPECT_EQ(run.status, 0) << run.err;
    return Json::parse(run.out);
  }

 private:
  fs::path folder_;
};

std::string scene(const std::string& name) { return (scenes / (name + ".json")).string(); }

/// A scene that is small and right, to be made wrong.
Json right_scene() {
  return Json::parse(R"({
    "nuno_scene": 1, "particles": 8, "arrival_time": 0.5,
    "initial": [[0, 1], [1, 1]], "target": [[2, 1], [2.5, 1.3], [3, 1]],
    "cloth": {"mass": 0.1}
  })");
}

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

bool is_one_line(const std::string& text) {
  return !text.empty() && text.find('\n') == text.size() - 1;
}

/// Whether a JSON holds a null anywhere.
bool has_null(const Json& json) {
  return json.is_null() ||
         (json.is_structured() && std::any_of(json.begin(), json.end(), has_null));
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
      {"FieldTwice", replaced(right_scene().dump(), "{", R"({"particles": 4, )"), "/",
       "\"particles\"", "twice"},
      {"NoVersion", without("/nuno_scene"), "/nuno_scene", "", "is missing"},
      {"VersionOfTheFuture", with("/nuno_scene", 2), "/nuno_scene", "2", "is not 1"},
      {"ResultInsteadOfScene", R"({"nuno_result": 1})", "/nuno_result", "\"nuno_result\"",
       "is not a known field"},
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
  EXPECT_EQ(run.status, 2) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_TRUE(is_one_line(run.err)) << run.err;
  EXPECT_TRUE(run.err.starts_with(file + ": " + bad.pointer + (bad.pointer.empty() ? "" : ": ")))
      << run.err;
  EXPECT_NE(run.err.find(bad.value), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(bad.rule), std::string::npos) << run.err;
  EXPECT_LT(run.err.size(), 400u) << "a line that a person can read";
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
       "nuno: \"simulat\" is not one of simulate, optimize, compare, studio, figures, render"},
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
       {"simulate", s, "--backend", "bullet"},
       "--backend: \"bullet\" is not one of native, box2d"},
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
      {"EmptyOutput", {"simulate", s, "--out", ""}, "--out: \"\" is not a name"},
      {"OutputMissing", {"compare", s, "--out"}, "--out: takes exactly one value"},
      {"NewlineInAnOption",
       {"simulate", s, "--backend", "a\nb"},
       "--backend: \"a b\" is not one of native, box2d"},
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
  EXPECT_TRUE(is_one_line(run.err) && run.err.starts_with("no-such.json: ")) << run.err;
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

// Outputs

class Output : public Program {};

TEST_F(Output, ToStandardOutputIsTheFileAndNothingElse) {
  const std::vector<std::string> arguments = {"simulate", scene("hanging-to-arch-32"), "--alpha",
                                              "0.0151", "--out"};
  auto to_file = arguments, to_stdout = arguments;
  to_file.push_back(output("result.json"));
  to_stdout.push_back("-");
  const Outcome file_run = nuno(to_file);
  const Outcome stdout_run = nuno(to_stdout);
  ASSERT_EQ(file_run.status, 0) << file_run.err;
  ASSERT_EQ(stdout_run.status, 0) << stdout_run.err;
  EXPECT_EQ(stdout_run.out, read_text(output("result.json")));
  EXPECT_EQ(stdout_run.err, file_run.out) << "the summary for people moves to standard error";
  EXPECT_EQ(file_run.err, "") << "no progress where there is no terminal";
}

TEST_F(Output, ReplacesAFileAndLeavesNothingBesideIt) {
  write_text(output("result.json"), std::string(1'000'000, 'x'));
  fs::permissions(output("result.json"), fs::perms{0600});
  ASSERT_EQ(nuno({"simulate", scene("s-curve-32"), "--out", output("result.json")}).status, 0);
  EXPECT_EQ(read_json(output("result.json"))["nuno_result"], 1);
  EXPECT_EQ(outputs(), std::set<std::string>{"result.json"});
  EXPECT_EQ(fs::status(output("result.json")).permissions(), fs::perms{0600});
}

TEST_F(Output, ThroughALinkKeepsTheLink) {
  write_text(in_folder("real.json"), "old");
  fs::create_symlink(in_folder("real.json"), output("link.json"));
  ASSERT_EQ(nuno({"simulate", scene("s-curve-32"), "--out", output("link.json")}).status, 0);
  EXPECT_TRUE(fs::is_symlink(output("link.json")));
  EXPECT_EQ(read_json(in_folder("real.json"))["nuno_result"], 1);
}

TEST_F(Output, ToADeviceGoesIntoTheDevice) {
  ASSERT_EQ(nuno({"simulate", scene("s-curve-32"), "--out", "/dev/null"}).status, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(Output, ThatCannotBeWrittenIsExitStatusOneAndNamesIt) {
  for (const std::string& path :
       {output("no/such/folder.json").string(), in_folder("outputs").string(),
        scene("s-curve-32") + "/file.json", std::string("/dev/full")}) {
    const Outcome run = nuno({"simulate", scene("s-curve-32"), "--out", path});
    EXPECT_EQ(run.status, 1) << path;
    EXPECT_TRUE(is_one_line(run.err) && run.err.starts_with(path + ": ")) << run.err;
  }
  EXPECT_TRUE(outputs().empty());
}

TEST_F(Output, FolderThatIsAFileIsExitStatusOne) {
  write_text(output("taken"), "precious");
  const Outcome run = nuno({"compare", scene("s-curve-32"), "--out", output("taken")});
  EXPECT_EQ(run.status, 1);
  EXPECT_TRUE(is_one_line(run.err)) << run.err;
  EXPECT_EQ(read_text(output("taken")), "precious");
}

TEST_F(Output, OnAFullStandardOutputIsExitStatusOne) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--help"},
        {"simulate", scene("s-curve-32")},
        {"simulate", scene("s-curve-32"), "--out", "-"}}) {
    EXPECT_EQ(Process(arguments, "/dev/full", in_folder("stderr")).wait(), 1);
    EXPECT_NE(read_text(in_folder("stderr")).find("standard output: cannot be written"),
              std::string::npos);
  }
}

TEST_F(Output, OfAnInterruptedRunIsNotThere) {
  write_text(output("result.json"), "precious");
  const Process process(
      {"simulate", scene("s-curve-32"), "--time-step", "5e-8", "--out", output("result.json")},
      in_folder("stdout"), in_folder("stderr"));
  std::this_thread::sleep_for(300ms);
  process.send(SIGINT);
  EXPECT_EQ(process.wait(), -SIGINT);
  EXPECT_EQ(read_text(output("result.json")), "precious");
  EXPECT_EQ(outputs(), std::set<std::string>{"result.json"});
}

// Results

class Result : public Program {};

TEST_F(Result, OfSeveralCoefficientsCanBeFlownAgain) {
  const std::string cloth = scene("s-curve-32");
  for (const std::string backend : {"native", "box2d"}) {
    const Json best = simulated({"optimize", cloth, "--backend", backend, "--coefficients", "2"});
    const Json alphas = best["alphas"];
    ASSERT_EQ(alphas.size(), 2u) << backend;
    EXPECT_EQ(best["alpha"], alphas.back());
    const Json stages = best["optimization"]["coefficients"]["stages"];
    ASSERT_EQ(stages.size(), 2u);
    EXPECT_EQ(stages[1]["alphas"], alphas);
    EXPECT_EQ(stages[1]["error"], best["error"]["mean"]);
    // By half on this scene, docs/coefficients.md.
    EXPECT_LT(stages[1]["error"], 0.6 * stages[0]["error"].get<double>());
    EXPECT_FALSE(has_null(best));

    std::string list = alphas.dump();  // [A,B]
    list = list.substr(1, list.size() - 2);
    const Json again = simulated({"simulate", cloth, "--backend", backend, "--alpha", list});
    EXPECT_EQ(again["final"], best["final"]);
    EXPECT_EQ(again["alphas"], alphas);
  }
}

TEST_F(Result, OfALimitCountsEveryRollout) {
  const Json result = simulated({"optimize", scene("s-curve-32"), "--effort-limit", "0.1"});
  // Launch only, 64 gains, and 30 halvings between the two about the limit.
  EXPECT_EQ(result["optimization"]["evaluations"], 1 + 64 + 30);
}

TEST_F(Result, OfAimingOffWithinALimitIsNoWorseThanOfTheGainAlone) {
  Json morph = read_json(scene("s-curve-32"));
  morph["reference"] = "morph";
  morph["damping_ratio"] = 0.7;
  write_text(in_folder("morph.json"), morph.dump());
  const auto effort = [](const Json& result) { return result["control_effort"].get<double>(); };
  const auto error = [](const Json& result) { return result["error"]["relative"].get<double>(); };
  for (const std::string& cloth : {scene("s-curve-32"), in_folder("morph.json").string()}) {
    for (const std::string limit : {"0.01", "0.5"}) {
      std::vector<std::string> command = {"optimize", cloth, "--effort-limit", limit};
      const Json alone = simulated(command);
      command.push_back("--refine");
      const Json refined = simulated(command);
      EXPECT_LE(effort(refined), std::stod(limit)) << cloth;
      EXPECT_LE(error(refined), error(alone)) << cloth << ' ' << limit;
    }
    for (const std::string limit : {"0.2", "0.05"}) {
      std::vector<std::string> command = {"optimize", cloth, "--error-limit", limit};
      const Json alone = simulated(command);
      command.push_back("--refine");
      const Json refined = simulated(command);
      EXPECT_LE(error(refined), std::stod(limit)) << cloth;
      EXPECT_LE(effort(refined), effort(alone)) << cloth << ' ' << limit;
    }
  }
}

TEST_F(Result, HasEveryFieldAndNoNull) {
  const Json result = simulated({"simulate", scene("s-curve-32"), "--alpha", "0.0181"});
  const std::set<std::string> expected = {
      "nuno_result",    "scene",      "backend",         "status",       "alpha",
      "time_step",      "steps",      "cloth_length",    "target_scale", "error",
      "control_effort", "final",      "launch_velocity", "target",       "frames",
      "max_strain",     "sensitivity"};
  std::set<std::string> fields;
  for (const auto& item : result.items()) fields.insert(item.key());
  EXPECT_EQ(fields, expected);
  EXPECT_EQ(result["scene"], "s-curve-32");
  EXPECT_EQ(result["backend"], "native");
  EXPECT_EQ(result["status"], "ok");
  EXPECT_FALSE(has_null(result));
  for (const char* shape : {"launch_velocity", "target", "final"}) {
    EXPECT_EQ(result[shape].size(), 32u) << shape;
  }
}

TEST_F(Result, ReadsTheGainBackToTheLastBit) {
  // 17 digits, which a detour through another format would round.
  const Json result =
      simulated({"simulate", scene("s-curve-32"), "--alpha", "0.018123456789012347"});
  EXPECT_EQ(result["alpha"].get<double>(), 0.018123456789012347);
}

TEST_F(Result, ErrorIsTheDistanceOfFinalAndTargetToTheLastDigits) {
  const Json result = simulated({"simulate", scene("s-curve-32"), "--alpha", "0.0181"});
  double sum = 0, largest = 0;
  for (std::size_t i = 0; i < 32; ++i) {
    const Json &a = result["final"][i], &b = result["target"][i];
    const double distance = std::hypot(a[0].get<double>() - b[0].get<double>(),
                                       a[1].get<double>() - b[1].get<double>());
    sum += distance;
    largest = std::max(largest, distance);
  }
  const Json& error = result["error"];
  // 32 additions round by at most 32 units in the last place.
  EXPECT_NEAR(error["mean"].get<double>(), sum / 32, 1e-14);
  EXPECT_NEAR(error["max"].get<double>(), largest, 1e-14);
  EXPECT_EQ(error["relative"].get<double>(),
            error["mean"].get<double>() / result["cloth_length"].get<double>());
}

TEST_F(Result, StepsEndAtTheArrivalTime) {
  for (const char* step : {"0.001", "0.0003", "0.007"}) {
    const Json result = simulated({"simulate", scene("s-curve-32"), "--time-step", step});
    // One rounding of the quotient, one of the product.
    EXPECT_NEAR(result["time_step"].get<double>() * result["steps"].get<double>(), 1, 1e-15);
  }
}

TEST_F(Result, FramesBeginAtTheInitialShapeAndEndAtTheFinalOne) {
  const Json result = simulated({"simulate", scene("hanging-to-arch-32"), "--alpha", "0.0151"});
  const Json &times = result["frames"]["times"], &positions = result["frames"]["positions"];
  ASSERT_EQ(times.size(), positions.size());
  EXPECT_EQ(times.size(), 49u) << "0.8 s at 60 frames per second, and the first";
  EXPECT_EQ(times.front(), 0.0);
  EXPECT_EQ(times.back(), 0.8);
  EXPECT_EQ(positions.front().front(), Json({0.0, 2.0}));
  EXPECT_EQ(positions.back(), result["final"]);
}

TEST_F(Result, IsNamedAfterTheFileIfTheSceneHasNoName) {
  write_text(in_folder("nameless.json"), right_scene().dump());
  EXPECT_EQ(simulated({"simulate", in_folder("nameless.json")})["scene"], "nameless");
}

TEST_F(Result, OfEitherBackendSaysWhichOneItWas) {
  EXPECT_EQ(simulated({"simulate", scene("s-curve-32"), "--backend", "box2d"})["backend"], "box2d");
}

TEST_F(Result, KeepsTheLimitThatWasAskedFor) {
  const std::string n = (scenes / "nuno" / "n1.json").string();
  const Json near = simulated({"optimize", n, "--error-limit", "0.01"});
  EXPECT_LE(near["error"]["relative"].get<double>(), 0.01);
  EXPECT_GT(near["error"]["relative"].get<double>(), 0.0099);
  EXPECT_GT(near["optimization"]["trade_off"].size(), 10u);
  const Json cheap = simulated({"optimize", n, "--effort-limit", "0.2"});
  EXPECT_LE(cheap["control_effort"].get<double>(), 0.2);
  EXPECT_GT(cheap["control_effort"].get<double>(), 0.199);
  const Json beyond = simulated({"optimize", n, "--error-limit", "0"});
  EXPECT_EQ(beyond["optimization"]["status"], "budget");
}

TEST_F(Result, OfAimingOffIsNearerAndSaysWhereItAimed) {
  const std::string n = (scenes / "nuno" / "n1.json").string();
  const Json plain = simulated({"optimize", n});
  const Json refined = simulated({"optimize", n, "--refine"});
  EXPECT_LT(refined["error"]["mean"].get<double>(), 0.7 * plain["error"]["mean"].get<double>());
  EXPECT_LT(refined["control_effort"].get<double>(), plain["control_effort"].get<double>());
  const Json& refinement = refined["optimization"]["refinement"];
  ASSERT_EQ(refinement["aim_offset"].size(), 4u);
  for (const Json& offset : refinement["aim_offset"]) {
    EXPECT_EQ(offset.size(), refined["final"].size());
  }
  const Json before = simulated({"simulate", n, "--alpha", Json(refined["alpha"]).dump()});
  EXPECT_EQ(refinement["error_before"], before["error"]["mean"]);
}

TEST_F(Result, OfAimingOffKeepsTheLimitThatWasAskedFor) {
  const std::string n = (scenes / "nuno" / "n1.json").string();
  const Json exact = simulated({"optimize", n, "--refine"});
  const double effort = 0.5 * exact["control_effort"].get<double>();
  const Json cheap = simulated({"optimize", n, "--refine", "--effort-limit", Json(effort).dump()});
  EXPECT_LE(cheap["control_effort"].get<double>(), effort);
  EXPECT_GT(cheap["control_effort"].get<double>(), 0.8 * effort);
  const Json near = simulated({"optimize", n, "--refine", "--error-limit", "0.01"});
  EXPECT_LE(near["error"]["relative"].get<double>(), 0.01);
  EXPECT_LT(near["control_effort"].get<double>(), exact["control_effort"].get<double>());
}

TEST_F(Result, OfOptimizeIsTheRolloutThatSimulateGivesAtItsGain) {
  for (const char* optimizer : {"global", "steepest-descent"}) {
    const Json best = simulated({"optimize", scene("s-curve-32"), "--optimizer", optimizer});
    const Json again =
        simulated({"simulate", scene("s-curve-32"), "--alpha", Json(best["alpha"]).dump()});
    EXPECT_EQ(best["final"], again["final"]) << optimizer;
    EXPECT_EQ(best["error"], again["error"]) << optimizer;

    const Json& optimization = best["optimization"];
    EXPECT_EQ(optimization["optimizer"], optimizer);
    EXPECT_EQ(optimization["status"], "converged");
    EXPECT_GT(optimization["seconds"].get<double>(), 0);
    EXPECT_GE(optimization["evaluations"].get<std::size_t>(), optimization["history"].size());
    double least = HUGE_VAL;
    for (const Json& entry : optimization["history"]) {
      least = std::min(least, entry["error"].get<double>());
    }
    EXPECT_NEAR(least, best["error"]["mean"].get<double>(), 1e-12) << optimizer;
  }
}

TEST_F(Result, OfARobustSearchHasTheMeanErrorOverFiveStarts) {
  const Json best = simulated({"optimize", scene("s-curve-32"), "--robust"});
  const Json& optimization = best["optimization"];
  EXPECT_EQ(optimization["evaluations"].get<int>() % 5, 0);
  // Calm, so that a disturbance of a thousandth changes little.
  EXPECT_NEAR(optimization["robust_error"].get<double>(), best["error"]["mean"].get<double>(),
              1e-3);
  EXPECT_LT(best["sensitivity"], 10);
}

TEST_F(Result, SaysInWordsThatAnAnswerIsFragile) {
  const Outcome fragile = nuno({"simulate", scene("letter-z"), "--alpha", "0.4"});
  EXPECT_NE(fragile.out.find("fragile: a change at the start grows "), std::string::npos)
      << fragile.out;
  const Outcome calm = nuno({"simulate", scene("s-curve-32"), "--alpha", "0.0181"});
  EXPECT_EQ(calm.out.find("fragile"), std::string::npos) << calm.out;
  EXPECT_GT(simulated({"simulate", scene("letter-z"), "--alpha", "0.4"})["sensitivity"], 1000);
}

TEST_F(Result, OfAGainTooLargeForTheDefaultStepTakesAShorterOne) {
  const Json calm = simulated({"simulate", scene("s-curve-32")});
  const Json strong = simulated({"simulate", scene("s-curve-32"), "--alpha", "1000"});
  EXPECT_LT(strong["time_step"].get<double>(), calm["time_step"].get<double>());
}

TEST_F(Result, OfARolloutThatDivergesIsExitStatusThreeAndNoFile) {
  // The first gain of these that is beyond what Box2D's single precision holds.
  Outcome run;
  for (const char* gain : {"1e8", "1e9", "1e10"}) {
    run = nuno({"simulate", scene("s-curve-32"), "--backend", "box2d", "--alpha", gain, "--out",
                output("result.json")});
    if (run.status != 0) break;
    fs::remove(output("result.json"));
  }
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(run.out, "");
  EXPECT_TRUE(is_one_line(run.err)) << run.err;
  EXPECT_NE(run.err.find("s-curve-32.json: diverged on box2d at α = "), std::string::npos)
      << run.err;
  EXPECT_NE(run.err.find(" in step "), std::string::npos) << run.err;
  // The engine's own reason, not what came of it.
  EXPECT_NE(run.err.find("than Box2D"), std::string::npos) << run.err;
  EXPECT_TRUE(outputs().empty());
}

// Comparisons

class ComparisonOfEngines : public Program {
 protected:
  /// A folder of two small scenes, so that a comparison takes little time.
  fs::path two_scenes() const {
    const fs::path folder = in_folder("scenes");
    fs::create_directory(folder);
    Json first = right_scene();
    first["particles"] = 5;
    first["time_step"] = 0.005;
    Json second = first;
    first["name"] = "flat";
    second["name"] = "soft";
    second["cloth"]["hinge_stiffness"] = 1e-4;
    write_text(folder / "b.json", second.dump());
    write_text(folder / "a.json", first.dump());
    write_text(folder / "notes.txt", "no scene");
    return folder;
  }
};

TEST_F(ComparisonOfEngines, OfAFolderHasItsScenesInAlphabeticalOrder) {
  const Outcome run = nuno({"compare", two_scenes(), "--out", output("a/b")});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json comparison = read_json(output("a/b/compare.json"));
  EXPECT_EQ(comparison["nuno_comparison"], 1);
  ASSERT_EQ(comparison["scenes"].size(), 2u);
  EXPECT_EQ(comparison["scenes"][0]["scene"], "flat");
  EXPECT_EQ(comparison["scenes"][1]["scene"], "soft");
  for (const char* figure :
       {"01-flat-gain", "01-flat-trade-off", "01-flat-flight", "02-soft-gain"}) {
    const fs::path file = output("a/b/figures") / (std::string(figure) + ".svg");
    EXPECT_TRUE(fs::exists(file)) << file;
  }
}

TEST_F(ComparisonOfEngines, HasEveryFieldAndACommonCurve) {
  const Json comparison = simulated({"compare", two_scenes() / "a.json"});
  const Json& entry = comparison["scenes"][0];
  ASSERT_EQ(entry["rows"].size(), 2u);
  EXPECT_EQ(entry["rows"][0]["backend"], "native");
  EXPECT_EQ(entry["rows"][1]["backend"], "box2d");
  for (const Json& row : entry["rows"]) {
    for (const char* field :
         {"launch_only_error", "alpha", "error", "max_error", "centroid_error", "control_effort",
          "max_strain", "sensitivity", "evaluations", "seconds", "error_with_the_other_alpha"}) {
      EXPECT_TRUE(row[field].is_number()) << field;
    }
    EXPECT_LE(row["error"], row["launch_only_error"]) << "gain 0 is among the gains it tries";
  }
  EXPECT_EQ(entry["shape_difference"]["at_alpha"], entry["rows"][0]["alpha"]);
  EXPECT_LE(entry["shape_difference"]["mean"], entry["shape_difference"]["max"]);

  const Json& curve = entry["alpha_curve"];
  ASSERT_EQ(curve["alpha"].size(), curve["native"].size());
  ASSERT_EQ(curve["alpha"].size(), curve["box2d"].size());
  EXPECT_TRUE(std::is_sorted(curve["alpha"].begin(), curve["alpha"].end()));
  EXPECT_EQ(curve["alpha"][0], 0.0);
  for (const std::size_t engine : {0u, 1u}) {
    const Json& row = entry["rows"][engine];
    const Json& efforts = curve["control_effort"][row["backend"].get<std::string>()];
    ASSERT_EQ(efforts.size(), curve["alpha"].size());
    EXPECT_EQ(efforts[0], 0.0);
    constexpr std::size_t one = 40;
    const Json flight =
        simulated({"simulate", in_folder("scenes") / "a.json", "--backend",
                   row["backend"].get<std::string>(), "--alpha", curve["alpha"][one].dump()});
    EXPECT_EQ(efforts[one], flight["control_effort"]);
    EXPECT_EQ(curve[row["backend"].get<std::string>()][one], flight["error"]["mean"]);
  }
  EXPECT_NEAR(curve["native"][0].get<double>(), entry["rows"][0]["launch_only_error"].get<double>(),
              1e-12);
}

TEST_F(ComparisonOfEngines, FindsOnNativeWhatOptimizeFinds) {
  const fs::path file = two_scenes() / "a.json";
  const Json comparison = simulated({"compare", file});
  const Json best = simulated({"optimize", file});
  const Json& row = comparison["scenes"][0]["rows"][0];
  EXPECT_EQ(row["alpha"], best["alpha"]);
  EXPECT_EQ(row["error"], best["error"]["mean"]);
  EXPECT_EQ(row["evaluations"], best["optimization"]["evaluations"]);
}

TEST_F(ComparisonOfEngines, ShowsATableOfALineForEachEngine) {
  const Outcome run = nuno({"compare", two_scenes()});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  for (const char* word : {"launch only", "best α", "error", "evaluations", "time", "flat", "soft",
                           "2 scenes are well-conditioned"}) {
    EXPECT_NE(run.out.find(word), std::string::npos) << word;
  }
}

// The scenes that come with the program, and its help

TEST_F(Program, SolvesEverySceneThatComesWithIt) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(scenes)) {
    if (entry.path().extension() != ".json") continue;
    const Json result = simulated({"optimize", entry.path()});
    EXPECT_LT(result["error"]["relative"], 0.1) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 10);
}

TEST_F(Program, HelpsOnItsCommandsAndTellsItsVersion) {
  EXPECT_TRUE(nuno({"--version"}).out.starts_with("nuno "));
  const Outcome help = nuno({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const std::string command : {"simulate", "optimize", "compare"}) {
    EXPECT_NE(help.out.find(command), std::string::npos);
    const Outcome run = nuno({command, "--help"});
    EXPECT_EQ(run.status, 0);
    EXPECT_NE(run.out.find("--out"), std::string::npos);
    for (const std::string choice : {"\"hold\"", "\"morph\"", "\"damping_ratio\"", "\"settle\""}) {
      EXPECT_NE(run.out.find(choice), std::string::npos) << command << ": " << choice;
    }
    EXPECT_EQ(run.err, "");
  }
}

}  // namespace
