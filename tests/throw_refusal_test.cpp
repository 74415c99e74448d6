// What is wrong with a command line of `nuno throw` is refused at the door.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sheet_refusal.h"

namespace nuno {
namespace {

TEST_F(SheetRefusal, OfAThrowOutOfRangeNamesTheFieldAndTheValue) {
  write_meshes(square, square);
  const std::string source =
      in_folder("start.obj").string() + " to " + in_folder("target.obj").string() + ": ";
  const std::vector<std::string> meshes = {"throw", in_folder("start.obj"),
                                           in_folder("target.obj")};
  const auto with_options = [&](std::vector<std::string> options) {
    options.insert(options.begin(), meshes.begin(), meshes.end());
    return options;
  };
  expect_refused(with_options({"--time", "1e-300"}), "a.glb", source + "/arrival_time: ", "1e-300",
                 "is not within");
  expect_refused(with_options({"--time", "1e13"}), "a.glb",
                 source + "/arrival_time: ", "10000000000000", "is not within");
  expect_refused(with_options({"--time", "1e7"}), "a.glb", source + "/", "", "");
  expect_refused(with_options({"--time", "1", "--frames-per-second", "1e10"}), "a.glb",
                 source + "/frames_per_second: ", "10000000000", "is not <= ");
}

struct BadThrow {
  std::string name;
  std::vector<std::string> arguments;  ///< after the two meshes
  std::string message;
};

void PrintTo(const BadThrow& bad, std::ostream* out) { *out << bad.name; }

class MalformedThrow : public SheetRefusal, public testing::WithParamInterface<BadThrow> {};

TEST_P(MalformedThrow, IsRefusedInOneLine) {
  write_meshes(square, square);
  std::vector<std::string> command = {"throw", in_folder("start.obj"), in_folder("target.obj")};
  command.insert(command.end(), GetParam().arguments.begin(), GetParam().arguments.end());
  const Outcome run = nuno(command);
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(run.err, GetParam().message + "\n");
}

INSTANTIATE_TEST_SUITE_P(
    EachOf, MalformedThrow,
    testing::Values(
        BadThrow{"NoTime", {}, "--time: is missing; it is required"},
        BadThrow{"TimeOfZero", {"--time", "0"}, "--time: 0 is not > 0"},
        BadThrow{"TimeNegative", {"--time", "-1"}, "--time: -1 is not > 0"},
        BadThrow{"TimeIsNan", {"--time", "nan"}, "--time: \"nan\" is not a finite number"},
        BadThrow{"TimeIsInfinite", {"--time", "inf"}, "--time: \"inf\" is not a finite number"},
        BadThrow{"TimeWithUnit", {"--time", "1s"}, "--time: \"1s\" is not a finite number"},
        BadThrow{"TimeMissing", {"--time"}, "--time: takes exactly one value"},
        BadThrow{"TimeTwice", {"--time", "1", "--time", "2"}, "--time: takes exactly one value"},
        BadThrow{"ThirdMesh", {"c.obj", "--time", "1"}, "\"c.obj\": is one argument too many"},
        BadThrow{"UnknownMaterial",
                 {"--time", "1", "--material", "velvet"},
                 "--material: \"velvet\" is not one of cotton, silk, denim, wool"},
        BadThrow{"BackendOfNobody",
                 {"--time", "1", "--backend", "ode"},
                 "--backend: \"ode\" is not one of native, box2d, bullet"},
        BadThrow{"NoFrames",
                 {"--time", "1", "--frames-per-second", "0"},
                 "--frames-per-second: 0 is not > 0"},
        BadThrow{"SettleWithAValue", {"--time", "1", "--settle=1"}, "--settle: takes no value"},
        BadThrow{"SettleWithAWord",
                 {"--time", "1", "--settle", "soon"},
                 "\"soon\": is one argument too many"},
        BadThrow{"OutputOfNoKnownKind",
                 {"--time", "1", "--out", "flight.fbx"},
                 "--out: \"flight.fbx\" does not end in .json or .glb, .pc2, .mdd, .usda, .obj"},
        BadThrow{"OutputWithoutKind",
                 {"--time", "1", "--out", "flight"},
                 "--out: \"flight\" does not end in .json or .glb, .pc2, .mdd, .usda, .obj"},
        BadThrow{"OutputEmpty", {"--time", "1", "--out", ""}, "--out: \"\" is not a name"},
        BadThrow{"GainGiven", {"--time", "1", "--alpha", "1"}, "--alpha: is not a known option"}),
    [](const auto& bad) { return bad.param.name; });

TEST_F(SheetRefusal, OfAThrowWithoutMeshesNamesWhatIsMissing) {
  EXPECT_EQ(nuno({"throw"}).err, "START: is missing; it is required\n");
  write_meshes(square, square);
  EXPECT_EQ(nuno({"throw", in_folder("start.obj"), "--time", "1"}).err,
            "TARGET: is missing; a START of glTF can hold it as a morph target, a drawing as a "
            "line\n");
  EXPECT_EQ(nuno({"throw", "", "b.obj", "--time", "1"}).err, "START: \"\" is not a name\n");
}

}  // namespace
}  // namespace nuno
