// What is wrong with a mesh in OBJ, or with a pair of them, is refused at the door.

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "sheet_refusal.h"

namespace nuno {
namespace {

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
      in_both("Binary", std::string("\x7f\0ELF\x01\xff\xfe\x1b[2J\n\0\0", 14), "", "",
              "is a binary file"),
      in_both("Utf16", wide(square), "", "", "is UTF-16: save it as UTF-8"),
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
