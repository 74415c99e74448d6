// What is wrong with a mesh or a sheet's scene is refused at the door.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "program.h"

namespace nuno {
namespace {

/// 3 × 3 vertices on 4 quads, in the plane y = 0: vertices on lines 1 … 9, faces on 10 … 13.
const std::string square =
    "v 0 0 0\nv 0.5 0 0\nv 1 0 0\n"
    "v 0 0 0.5\nv 0.5 0 0.5\nv 1 0 0.5\n"
    "v 0 0 1\nv 0.5 0 1\nv 1 0 1\n"
    "f 1 4 5 2\nf 2 5 6 3\nf 4 7 8 5\nf 5 8 9 6\n";

std::string replaced(std::string text, const std::string& old, const std::string& fresh) {
  return text.replace(text.find(old), old.size(), fresh);
}
std::string square_with(const std::string& old, const std::string& fresh) {
  return replaced(square, old, fresh);
}

/// UTF-16, as an editor of Windows may save it.
std::string wide(const std::string& text) {
  std::string result = "\xff\xfe";
  for (const char c : text) result += {c, '\0'};
  return result;
}

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

// Meshes

struct BadMesh {
  std::string name;
  std::string start, target;
  std::string at;     ///< file and line that the message names
  std::string value;  ///< that it shows
  std::string rule;   ///< that it says was broken
};

void PrintTo(const BadMesh& bad, std::ostream* out) { *out << bad.name; }

/// Both files have the fault; the start's is named.
BadMesh in_both(const std::string& name, const std::string& mesh, const std::string& line,
                const std::string& value, const std::string& rule) {
  return {name, mesh, mesh, "start.obj" + line, value, rule};
}
BadMesh in_target(const std::string& name, const std::string& mesh, const std::string& line,
                  const std::string& value, const std::string& rule) {
  return {name, square, mesh, "target.obj" + line, value, rule};
}

/// What is no mesh at all.
std::vector<BadMesh> no_meshes() {
  const std::string vertices = square.substr(0, square.find('f'));
  return {
      in_both("Empty", "", "", "", "has no face"),
      in_both("OnlyBlanks", " \n\r\n\t\n", "", "", "has no face"),
      in_both("OnlyVertices", vertices, "", "", "has no face"),
      in_both("OnlyPoints", vertices + "p 1 2 3\n", "", "", "has no face"),
      in_both("Binary", std::string("\x7f\0ELF\x01\xff\xfe\x1b[2J\n\0\0", 14), ":1", "ELF",
              "is not a statement"),
      in_both("Utf16", wide(square), ":1", "v", "is not a statement"),
      in_both("Scene", R"({"nuno_scene": 1})", ":1", R"({"nuno_scene":)", "is not a statement"),
      in_both("Stl", "solid cloth\nfacet normal 0 1 0\n", ":1", "solid", "is not a statement"),
      in_both("Ply", "ply\nformat ascii 1.0\n", ":1", "ply", "is not a statement"),
      in_both("OneLongWord", std::string(100'000, 'x'), ":1", "xxx", "is not a statement"),
  };
}

std::vector<BadMesh> bad_numbers() {
  const std::string most = "is not within ±1000000000000";
  return {
      in_both("CoordinateNan", square_with("v 1 0 0", "v 1 nan 0"), ":3", "nan", "is not a number"),
      in_both("CoordinateInfinite", square_with("v 1 0 0", "v inf 0 0"), ":3", "inf", most),
      in_both("CoordinateBeyondDoubles", square_with("v 1 0 0", "v 1e400 0 0"), ":3", "1e400",
              most),
      in_target("CoordinateBeyondCloth", square_with("v 1 0 0", "v 1e13 0 0"), ":3", "1e13", most),
      in_target("CoordinateInWords", square_with("v 1 0 0", "v one 0 0"), ":3", "one",
                "is not a number"),
      in_both("CoordinateMissing", square_with("v 1 0 0", "v 1 0"), ":3", "1 0",
              "has not 3 numbers"),
      in_both("CommaInCoordinate", square_with("v 0.5 0 0", "v 0,5 0 0"), ":2", "0,5",
              "is not a number"),
      in_both("IndexOfZero", square_with("f 1 4", "f 0 4"), ":10", "0 names a vertex",
              "not among the 9 above"),
      in_both("IndexOutOfRange", square_with("8 9 6", "8 10 6"), ":13", "10 names a vertex",
              "not among the 9 above"),
      in_both("IndexTooFarBack", square_with("8 9 6", "8 -10 6"), ":13", "-10 names a vertex",
              "not among the 9 above"),
      in_both("IndexBeyondIntegers", square_with("8 9 6", "8 123456789012345678901 6"), ":13",
              "123456789012345678901", "is not a corner"),
      in_both("IndexInWords", square_with("8 9 6", "8 nine 6"), ":13", "nine", "is not a corner"),
      in_both("TextureThatIsNotThere", square_with("8 9 6", "8/1 9 6"), ":13", "8/1",
              "texture point"),
      in_target("VertexAfterItsFace", "f 1 2 3\n" + square, ":1", "1 names a vertex",
                "not among the 0 above"),
  };
}

std::vector<BadMesh> bad_faces() {
  return {
      in_both("TwoCorners", square_with("f 5 8 9 6", "f 5 8"), ":13", "5 8",
              "fewer than 3 corners"),
      in_both("NoCorners", square_with("f 5 8 9 6", "f"), ":13", "f", "fewer than 3 corners"),
      in_both("ThousandsOfCorners", square + "f" + repeated(" 1", 5000), ":14", "1 1 1",
              "has more than 1000 corners"),
      in_both("VertexTwice", square_with("5 8 9 6", "5 8 9 8"), ":13", "5 8 9 8",
              "has vertex 8 twice"),
      in_both("VertexTwiceInAPolygon", square_with("5 8 9 6", "5 8 9 6 9"), ":13", "5 8 9 6 9",
              "has vertex 9 twice"),
      in_both("FaceWithoutArea", square + "f 1 2 3\n", ":14", "1 2 3", "has no area at vertex 1"),
      in_both("EdgeWithoutLength", square_with("v 1 0 1\n", "v 1 0 0.5\n"), ":13", "5 8 9 6",
              "the edge from vertex 9 to 6 has no length"),
      in_both("QuadThatFoldsBack", square_with("v 1 0 1\n", "v 0.6 0 0.6\n"), ":13", "5 8 9 6",
              "is a quad that is not convex at vertex 9"),
      in_both("QuadLikeABowTie", square_with("5 8 9 6", "5 9 8 6"), ":13", "5 9 8 6",
              "is a quad that is not convex"),
      in_both("EdgeOfThreeFaces", square_with("v 0 0 0\n", "v 0 1 0\n") + "f 5 2 9\n", ":14",
              "5 2 9", "is the third face at the edge from vertex 2 to 5"),
      in_both("FaceTwice", square + "f 1 4 5 2\nf 1 4 5 2\n", ":14", "1 4 5 2",
              "is the third face at the edge"),
      in_both("AMillionFacesOnOneAnother", square + repeated("f 1 4 5 2\n", 1'000'000), ":14",
              "1 4 5 2", "is the third face at the edge"),
      in_both("VertexInNoFace", square + "v 5 5 5\n", ":14", "vertex 10", "is in no face"),
      in_both("TwoSheets", square + "v 5 0 0\nv 6 0 0\nv 5 0 1\nf -3 -2 -1\n", "", "vertex 10",
              "are separate sheets, not a single one"),
      in_both("NoSize", repeated("v 1 1 1\n", 9) + square.substr(square.find('f')), "", "size 0",
              "is not >= 1e-12"),
      in_both("SizeBelowAnyCloth", "v 0 0 0\nv 1e-13 0 0\nv 0 0 1e-13\nf 1 2 3\n", "", "size 1.4",
              "is not >= 1e-12"),
  };
}

std::vector<BadMesh> bad_pairs() {
  return {
      in_target("FewerVertices", replaced(square_with("v 1 0 1\n", ""), "f 5 8 9 6\n", ""), "",
                "8 vertices are not 9", "no pose of the same mesh"),
      in_target("MoreVertices", square + "v 5 5 5\n", "", "10 vertices are not 9",
                "no pose of the same mesh"),
      in_target("FewerFaces", square_with("f 5 8 9 6\n", ""), "", "3 faces are not 4",
                "no pose of the same mesh"),
      in_target("FacesDiffer", square_with("f 5 8 9 6", "f 5 8 9"), ":13", "5 8 9",
                "no pose of the same mesh"),
      in_target("FacesInAnotherOrder",
                square_with("f 1 4 5 2\nf 2 5 6 3\n", "f 2 5 6 3\nf 1 4 5 2\n"), ":10", "2 5 6 3",
                "the vertices stand in another order"),
      in_target("FaceFromAnotherCornerOn", square_with("f 5 8 9 6", "f 8 9 6 5"), ":13", "8 9 6 5",
                "the vertices stand in another order"),
      in_target("PointAsTarget", repeated("v 1 1 1\n", 9) + square.substr(square.find('f')), "",
                "size 0", "is not >= 1e-12"),
      in_target("EmptyTarget", "", "", "", "has no face"),
  };
}

std::vector<BadMesh> bad_meshes() {
  std::vector<BadMesh> all;
  for (const auto& some : {no_meshes(), bad_numbers(), bad_faces(), bad_pairs()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

/// A sheet's scene of the two meshes beside it.
Json sheet_scene() {
  return Json::parse(R"({
    "nuno_scene": 1, "arrival_time": 0.5, "initial": "start.obj", "target": "target.obj",
    "cloth": {"areal_density": 0.15}
  })");
}

class SheetRefusal : public Program {
 protected:
  /// The command is refused with one line that begins with these words, and touches no output.
  void expect_refused(std::vector<std::string> command, const std::string& out,
                      const std::string& start, const std::string& value,
                      const std::string& rule) const {
    write_text(output(out), "precious");
    command.insert(command.end(), {"--out", output(out)});
    const Outcome run = nuno(command);
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_TRUE(is_one_line(run.err)) << run.err;
    EXPECT_TRUE(run.err.starts_with(start)) << run.err << "not after " << start;
    EXPECT_NE(run.err.find(value), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(rule), std::string::npos) << run.err;
    EXPECT_LT(run.err.size(), 400u) << "a line that a person can read";
    for (const char c : run.err.substr(0, run.err.size() - 1)) {
      EXPECT_GE(static_cast<unsigned char>(c), ' ') << "no code for a terminal";
    }
    EXPECT_EQ(read_text(output(out)), "precious");
    EXPECT_EQ(outputs(), std::set<std::string>{out});
    fs::remove(output(out));
  }

  void write_meshes(const std::string& start, const std::string& target) const {
    write_text(in_folder("start.obj"), start);
    write_text(in_folder("target.obj"), target);
  }

  std::vector<std::string> throw_command() const {
    return {"throw", in_folder("start.obj"), in_folder("target.obj"), "--time", "0.5"};
  }
};

class MalformedMesh : public SheetRefusal, public testing::WithParamInterface<BadMesh> {};

TEST_P(MalformedMesh, IsRefusedInOneLineThatSaysWhereAndWhyAndTouchesNoOutput) {
  const BadMesh& bad = GetParam();
  write_meshes(bad.start, bad.target);
  const std::string at = in_folder(bad.at).string() + ": ";
  expect_refused(throw_command(), "flight.glb", at, bad.value, bad.rule);
  if (bad.start.size() > 1'000'000) return;  // once is enough
  write_text(in_folder("sheet.json"), sheet_scene().dump());
  for (const char* command : {"simulate", "optimize"}) {
    expect_refused({command, in_folder("sheet.json")}, "flight.glb", at, bad.value, bad.rule);
  }
}

INSTANTIATE_TEST_SUITE_P(EachOf, MalformedMesh, testing::ValuesIn(bad_meshes()),
                         [](const auto& bad) { return bad.param.name; });

// Scenes

struct BadScene {
  std::string name;
  std::string text;
  std::string pointer;  ///< of the field that the message names
  std::string value;    ///< that it shows
  std::string rule;     ///< that it says was broken
};

void PrintTo(const BadScene& bad, std::ostream* out) { *out << bad.name; }

std::string with(const std::string& pointer, const Json& value) {
  Json scene = sheet_scene();
  scene[Json::json_pointer(pointer)] = value;
  return scene.dump();
}

std::vector<BadScene> bad_scenes() {
  const auto polyline = Json::parse("[[0, 1], [1, 1]]");
  return {
      {"ParticlesGiven", with("/particles", 9), "/particles", "\"particles\"",
       "is not a known field"},
      {"UnknownMaterial", with("/material", "velvet"), "/material", "\"velvet\"",
       "is not one of cotton, silk, denim, wool"},
      {"MaterialIsANumber", with("/material", 3), "/material", "3", "is not a string"},
      {"UnknownRest", with("/rest", "curved"), "/rest", "\"curved\"",
       "is not \"initial\" or \"flat\""},
      {"RestIsANumber", with("/rest", 0), "/rest", "0", "is not \"initial\" or \"flat\""},
      {"MeshIsANumber", with("/initial", 5), "/initial", "5", "is not an array of points"},
      {"MeshIsNull", with("/target", nullptr), "/target", "null", "is not a string"},
      {"MeshAndPolyline", with("/target", polyline), "/target", "[[0.0,1.0],[1.0,1.0]]",
       "is not a string"},
      {"PolylineAndMesh", with("/initial", polyline), "/target", "\"target.obj\"",
       "is not an array of points"},
      {"MaterialOfAChain", replaced(with("/material", "silk"), "\"start.obj\"", "[[0,1],[1,1]]"),
       "/material", "\"material\"", "is not a known field"},
      {"MassOfAChain", with("/cloth/mass", 0.1), "/cloth/mass", "\"mass\"", "is not a known field"},
      {"NoDensity", with("/cloth/areal_density", 0), "/cloth/areal_density", "0", "is not > 0"},
      {"NegativeDensity", with("/cloth/areal_density", -1), "/cloth/areal_density", "-1",
       "is not > 0"},
      {"NegativeDrag", with("/cloth/air_drag", -1), "/cloth/air_drag", "-1", "is not >= 0"},
      {"DragLikeStone", with("/cloth/air_drag", 1e9), "/cloth/air_drag", "1000000000", "<= 700"},
      {"NoStretchStiffness", with("/cloth/stretch_stiffness", 0), "/cloth/stretch_stiffness", "0",
       "is not > 0"},
      {"NegativeStretchDamping", with("/cloth/stretch_damping", -1), "/cloth/stretch_damping", "-1",
       "is not >= 0"},
      {"NegativeShearStiffness", with("/cloth/shear_stiffness", -1), "/cloth/shear_stiffness", "-1",
       "is not >= 0"},
      {"NegativeShearDamping", with("/cloth/shear_damping", -1), "/cloth/shear_damping", "-1",
       "is not >= 0"},
      {"NegativeBendingStiffness", with("/cloth/bending_stiffness", -1), "/cloth/bending_stiffness",
       "-1", "is not >= 0"},
      {"NegativeBendingDamping", with("/cloth/bending_damping", -1), "/cloth/bending_damping", "-1",
       "is not >= 0"},
      {"StiffnessBeyondCloth", with("/cloth/stretch_stiffness", 1e13), "/cloth/stretch_stiffness",
       "10000000000000", "is not within"},
      {"StiffnessInWords", with("/cloth/stretch_stiffness", "high"), "/cloth/stretch_stiffness",
       "\"high\"", "is not a number"},
      {"DensityBeyondDoubles", replaced(with("/cloth/areal_density", 7), "7", "1e400"), "/",
       "1e400", ""},
      {"ClothIsAList", with("/cloth", Json::array()), "/cloth", "[]", "is not an object"},
      {"ArrivalTimeOfZero", with("/arrival_time", 0), "/arrival_time", "0", "is not > 0"},
      {"NegativeGravity", with("/gravity", -9.8), "/gravity", "-9.8", "is not >= 0"},
      {"NegativeDampingRatio", with("/damping_ratio", -0.7), "/damping_ratio", "-0.7",
       "is not >= 0"},
      {"UnknownReference", with("/reference", "fade"), "/reference", "\"fade\"", "\"morph\""},
      {"UnknownArrival", with("/arrival", "stop"), "/arrival", "\"stop\"", "\"settle\""},
      {"TimeStepOfZero", with("/time_step", 0), "/time_step", "0", "is not > 0"},
      {"TimeStepThatTakesDays", with("/time_step", 1e-12), "/time_step", "1e-12", "is not >= "},
      {"NoFrames", with("/frames_per_second", 0), "/frames_per_second", "0", "is not > 0"},
      {"MoreFramesThanMemory", with("/frames_per_second", 1e12), "/frames_per_second",
       "1000000000000", "is not <= "},
      {"SoStiffThatItTakesDays", with("/cloth/bending_stiffness", 1e12), "/cloth/bending_stiffness",
       "6.2e+07 steps", "is not <= 50000000"},
      {"MisspelledField", with("/materiel", "silk"), "/materiel", "\"materiel\"",
       "the nearest is \"material\""},
      {"MisspelledClothField", with("/cloth/bending", 1), "/cloth/bending", "\"bending\"",
       "is not a known field"},
  };
}

class MalformedSheetScene : public SheetRefusal, public testing::WithParamInterface<BadScene> {};

TEST_P(MalformedSheetScene, IsRefusedInOneLineThatSaysWhereAndWhyAndTouchesNoOutput) {
  const BadScene& bad = GetParam();
  write_meshes(square, square);
  const std::string file = in_folder("bad.json").string();
  write_text(file, bad.text);
  for (const char* command : {"simulate", "optimize"}) {
    expect_refused({command, file}, "flight.glb", file + ": " + bad.pointer + ": ", bad.value,
                   bad.rule);
  }
}

INSTANTIATE_TEST_SUITE_P(EachOf, MalformedSheetScene, testing::ValuesIn(bad_scenes()),
                         [](const auto& bad) { return bad.param.name; });

TEST_F(SheetRefusal, OfAMeshThatIsNotThereNamesIt) {
  write_text(in_folder("start.obj"), square);
  const std::string rule = "cannot be opened for reading";
  const std::string target = in_folder("target.obj").string() + ": ";
  expect_refused(throw_command(), "flight.glb", target, "", rule);
  write_text(in_folder("sheet.json"), sheet_scene().dump());
  expect_refused({"simulate", in_folder("sheet.json")}, "flight.json", target, "", rule);
}

TEST_F(SheetRefusal, OfWhatIsNoMeshFileNamesIt) {
  write_meshes(square, square);
  fs::create_directory(in_folder("folder.obj"));
  const auto with_start = [&](const std::string& start) {
    return std::vector<std::string>{"throw", start, in_folder("target.obj"), "--time", "1"};
  };
  const std::string folder = in_folder("folder.obj");
  expect_refused(with_start(folder), "a.glb", folder + ": ", "", "is a directory, not a mesh");
  for (const char* name : {"start.stl", "start.json", "start"}) {
    const std::string file = in_folder(name);
    write_text(file, square);
    expect_refused(with_start(file), "a.glb", file + ": ", "", "does not end in .obj");
  }
  Json scene = sheet_scene();
  scene["initial"] = "";
  write_text(in_folder("sheet.json"), scene.dump());
  expect_refused({"simulate", in_folder("sheet.json")}, "a.json", in_folder("").string(), "",
                 "does not end in .obj");
}

TEST_F(SheetRefusal, OfWhatSheetsCannotHaveNamesTheSceneAndTheRule) {
  write_meshes(square, square);
  const std::string sheet = in_folder("sheet.json"), chain = in_folder("chain.json");
  write_text(sheet, sheet_scene().dump());
  write_text(chain, right_scene().dump());
  expect_refused({"simulate", sheet, "--backend", "box2d"}, "a.json", sheet + ": ",
                 "box2d does not fly a sheet", "those that do: native, bullet");
  expect_refused({"optimize", sheet, "--backend", "box2d"}, "a.json", sheet + ": ",
                 "box2d does not fly a sheet", "those that do: native, bullet");
  expect_refused({"simulate", chain, "--backend", "bullet"}, "a.json", chain + ": ",
                 "bullet does not fly a chain", "those that do: native, box2d");
  expect_refused({"optimize", sheet, "--refine"}, "a.json", sheet + ": /initial: ", "",
                 "a sheet is not refined");
  expect_refused({"optimize", sheet, "--coefficients", "2"}, "a.json", sheet + ": /initial: ", "2",
                 "a sheet takes one gain");
  expect_refused({"simulate", sheet, "--alpha", "1,2,3"}, "a.json", sheet + ": /initial: ", "3",
                 "a sheet takes one gain");
  expect_refused({"simulate", sheet, "--ribbon-width", "0.1"}, "a.glb", "--ribbon-width: ", sheet,
                 "is for a chain");
  expect_refused({"simulate", sheet, "--tail", "1"}, "a.json", "--tail: ", "",
                 "is for an animation");
  expect_refused({"simulate", sheet}, "a.obj", "--out: ", "a.obj", "has no # in its name");
}

TEST_F(SheetRefusal, OfATargetWithoutAreaNamesIt) {
  std::string line = square;  // all vertices on the x axis
  for (const char* z : {" 0 0.5\n", " 0 1\n"}) {
    while (line.find(z) != std::string::npos) line = replaced(line, z, " 0 0\n");
  }
  write_meshes(square, line);
  const std::string source =
      in_folder("start.obj").string() + " to " + in_folder("target.obj").string() + ": /target: ";
  expect_refused(throw_command(), "a.glb", source, "", "the mesh has no area to fit");
}

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

// Command lines

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
        BadThrow{"GainGiven", {"--time", "1", "--alpha", "1"}, "--alpha: is not a known option"},
        BadThrow{"RefineGiven", {"--time", "1", "--refine"}, "--refine: is not a known option"}),
    [](const auto& bad) { return bad.param.name; });

TEST_F(SheetRefusal, OfAThrowWithoutMeshesNamesWhatIsMissing) {
  EXPECT_EQ(nuno({"throw"}).err, "START: is missing; it is required\n");
  write_meshes(square, square);
  EXPECT_EQ(nuno({"throw", in_folder("start.obj"), "--time", "1"}).err,
            "TARGET: is missing; a START of glTF can hold it as a morph target, a drawing as a "
            "line\n");
  EXPECT_EQ(nuno({"throw", "", "b.obj", "--time", "1"}).err, "START: \"\" is not a name\n");
}

TEST_F(SheetRefusal, LetsFacesRunEitherWayRound) {
  const std::string turned = square_with("f 2 5 6 3", "f 3 6 5 2");
  write_meshes(turned, turned);
  std::vector<std::string> command = throw_command();
  command.insert(command.end(), {"--out", output("flight.glb")});
  EXPECT_EQ(nuno(command).status, 0);
  EXPECT_EQ(outputs(), std::set<std::string>{"flight.glb"});
}

}  // namespace
}  // namespace nuno
