// Broken drawings are refused at the door, and nothing outside the drawing is read.

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include <sys/resource.h>

#include "program.h"

namespace nuno {
namespace {

/// A text so often.
struct Repeated {
  std::string text;
  std::size_t count = 0;
};

struct BadDrawing {
  std::string name;
  std::string file;   ///< its name in the folder
  std::string text;   ///< what is in it
  std::string place;  ///< what the message has after the file's path
  std::string rule;
  std::string curve;   ///< of the file, "#…" or none: the only one
  Repeated many = {};  ///< what stands for @ in the text
};

void PrintTo(const BadDrawing& bad, std::ostream* out) { *out << bad.name; }

std::string repeated(const std::string& text, std::size_t count) {
  std::string result;
  result.reserve(text.size() * count);
  for (std::size_t i = 0; i < count; ++i) result += text;
  return result;
}

/// A drawing whose second line is what is wrong.
BadDrawing svg(const std::string& name, const std::string& elements, const std::string& place,
               const std::string& rule, const std::string& curve = "") {
  return {name, "bad.svg", "<svg>\n" + elements + "\n</svg>", place, rule, curve};
}

BadDrawing path(const std::string& name, const std::string& d, const std::string& rule) {
  return svg(name, "<path id=\"a\" d=\"" + d + "\"/>", ":2: path \"a\": ", rule);
}

std::vector<BadDrawing> bad_drawings() {
  const std::string line = "<line x2='1'/>";
  std::string bombs = "<g id='b0'>" + line + "</g>";
  for (int i = 1; i < 12; ++i) {
    const std::string use = "<use href='#b" + std::to_string(i - 1) + "'/>";
    bombs += "<g id='b" + std::to_string(i) + "'>" + repeated(use, 10) + "</g>";
  }
  std::vector<BadDrawing> all = {
      {"EmptyFile", "bad.svg", "", ":1: ", "is not XML in UTF-8", ""},
      {"NoXml", "bad.svg", "\x7f\0ELF", ":1: ", "is not XML in UTF-8", ""},
      {"CutOff", "bad.svg", "<svg><path d='M0 0", ":1: ", "is not XML in UTF-8", ""},
      {"Utf16", "bad.svg", std::string("\xff\xfe<\0s\0v\0g\0/\0>\0", 14), ": ",
       "is UTF-16: save it as UTF-8", ""},
      {"Html", "bad.svg", "<html><svg/></html>", ": ", "no svg element around", ""},
      {"NothingDrawn", "bad.svg", "<svg><text>a</text></svg>", ": ", "draws no path", ""},
      {"EntityBomb", "bad.svg",
       "<!DOCTYPE svg [<!ENTITY a 'M0 0L1 1'><!ENTITY b '&a;&a;&a;&a;&a;&a;'>]>"
       "<svg><path d='&b;'/></svg>",
       ":1: path: d: \"&b;\"", "is not a command", ""},
      {"ExternalEntity", "bad.svg",
       "<!DOCTYPE svg [<!ENTITY a SYSTEM 'secret.txt'>]><svg><path d='&a;'/></svg>",
       ":1: path: d: \"&a;\"", "is not a command", ""},
      {"PageOfNoWidth", "bad.svg", "<svg width='0' height='1'/>", ":1: svg: width: \"0\"",
       "is not > 0", ""},
      {"PageInAnUnknownUnit", "bad.svg", "<svg width='2em' height='1'/>", ":1: svg: width: \"2em\"",
       "has a unit that is not px, pt, pc, mm, cm, in, Q or %", ""},
      {"ViewBoxOfThree", "bad.svg", "<svg viewBox='0 0 1'/>",
       ":1: svg: viewBox: ", "ends where a number is due", ""},
      {"ViewBoxOfNoSize", "bad.svg", "<svg viewBox='0 0 0 1'/>", ":1: svg: viewBox: ", "> 0", ""},
      {"UnknownAspectRatio", "bad.svg", "<svg viewBox='0 0 1 1' preserveAspectRatio='xMid'/>",
       ":1: svg: preserveAspectRatio: \"xMid\"", "is not none", ""},
      {"DeepNesting", "bad.svg", "<svg>@", ":1: ", "", "", {"<g>", 1'000'000}},
      {"DeepNestingThatEnds", "bad.svg",
       "<svg>" + repeated("<g>", 5000) + repeated("</g>", 5000) + "</svg>",
       ":1: g: ", "nested more than 200 deep", ""},
      {"ManySmallElements",
       "bad.svg",
       "<svg>@</svg>",
       ": ",
       "draws more than 1000000 elements",
       "",
       {"<g/>", 8'000'000}},
      {"LargeFile",
       "bad.svg",
       "<svg><path d='@'/></svg>",
       ": ",
       "is larger than 32 MiB",
       "",
       {"L1 1", 25'000'000}},
      {"ManySegments",
       "bad.svg",
       "<svg><path d='M0 0@'/></svg>",
       ":1: path: d: ",
       "follows more than 1000000 segments",
       "",
       {"h1", 15'000'000}},
      {"ManyPoints",
       "bad.svg",
       "<svg><polyline points='0 0@'/></svg>",
       ":1: polyline: points: ",
       "follows more than 1000000 segments",
       "",
       {",1-1", 8'000'000}},
      {"UnknownExtension", "bad.dxf", "0\nSECTION\n", ": ", "does not end in", ""},
      {"ObjOfTwoLoops", "bad.obj",
       "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 5 5 0\nv 6 5 0\nv 6 6 0\nl 1 2 3 1\nl 4 5 6 4\n",
       ":7: ", "are not one line", ""},
      {"ObjThatBranches", "bad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 2 0\nl 1 2 3\nl 2 4\n",
       ":5: ", "3 segments meet at vertex 2", ""},
      {"ObjInTwoParts", "bad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 2 0\nl 1 2\nl 3 4\n",
       ":5: ", "there is a gap", ""},
      {"ObjInTheTopView", "bad.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nl 1 2 3\n",
       ":4: ", "draw it in the front view", ""},
      {"ObjOfOneVertex", "bad.obj", "v 0 0 0\nl 1\n", ":2: l ", "has fewer than 2 vertices", ""},
      {"ObjBeyondItsVertices", "bad.obj", "v 0 0 0\nl 1 2\n", ":2: 2 ", "is not among the 1", ""},
      {"ObjOfNan", "bad.obj", "v 0 0 nan\nl 1 2\n", ":1: nan ", "is not a number", ""},
      {"ObjOfAnotherName", "bad.obj", "o a\nv 0 0 0\nv 1 0 0\nl 1 2\n", ": ", "named \"b\"", "#b"},
      {"CsvOfThree", "bad.csv", "0,1\n1,2,3\n", ":2: ", "is not", ""},
      {"CsvOfOne", "bad.csv", "0,1\n1\n", ":2: 1 ", "is not two numbers: x,y", ""},
      {"CsvOfWords", "bad.csv", "0,1\n1,b\n", ":2: b ", "is not a number", ""},
      {"CsvOfInfinity", "bad.csv", "0,1\n1,inf\n", ":2: inf ", "is not within ±1000000000000", ""},
      {"CsvOfNothing", "bad.csv", "x,y\n", ": ", "has no point", ""},
      {"CsvOfOnePoint", "bad.csv", "1,2\n", " to ", "at least 2 distinct points", ""},
      {"CsvWithAName", "bad.csv", "0,1\n1,2\n", ": ", "a .csv has only one", "#a"},
      path("NoMove", "L1 1", "does not begin with M or m"),
      path("UnknownCommand", "M0 0X1 1", "\"X1 1\" at character 5 is not a command of a path"),
      path("HalfAPair", "M0 0L1", "ends where a number is due"),
      path("TwoCommas", "M0 0L1,,2", "is not a number"),
      path("CommaAtTheEnd", "M0 0L1 2,", "is not a number"),
      path("NumberInWords", "M0 0L1 NaN", "is not a number"),
      path("Infinity", "M0 0L1 1e999", "is not within ±1"),
      path("FlagOfTwo", "M0 0A1 1 0 2 0 1 1", "is not a flag of an arc, 0 or 1"),
      path("ArcCutOff", "M0 0A1 1 0 0", "is not a flag"),
      path("Subpaths", "M0 0L1 1M2 2L3 3", "has 2 subpaths, and a cloth is one line"),
      path("SubpathAfterAClosedOne", "M0 0L1 1L1 0ZL5 5", "has 2 subpaths"),
      path("OnePoint", "M3 3", "draws nothing"),
      svg("TwoPaths", line + line, ": ", "draws 2 paths; name one as"),
      svg("UnknownName", "<path id='abc' d='M0 0L1 1'/>", ": ",
          "draws 0 paths named \"x\", not one; its paths: \"abc\"", "#x"),
      svg("SameNameTwice", "<line id='a' x2='1'/><line id='a' x2='2'/>", ": ",
          "draws 2 paths named \"a\"", "#a"),
      svg("NameOfSeveralLines", line, ": ", "draws 0 paths named", "#a\nb"),
      svg("UnknownTransform", "<line x2='1' transform='turn(3)'/>",
          ":2: line: transform: ", "is not matrix"),
      svg("TransformWithAUnit", "<line x2='1' transform='rotate(3deg)'/>",
          ":2: line: transform: ", "is not a number or )"),
      svg("TransformOfFive", "<line x2='1' transform='matrix(1 2 3 4 5)'/>",
          ":2: line: transform: ", "is not matrix(6 numbers)"),
      svg("TransformsBeyondAllBounds",
          repeated("<g transform='scale(1e12)'>", 40) + line + repeated("</g>", 40),
          ":2: line: ", "beyond all bounds"),
      svg("TransformInAStyle", "<line x2='1' style='fill:red;transform:scale(2)'/>",
          ":2: line: style: \"transform\"", "is read from an attribute only"),
      svg("StyleSheetThatHides", "<defs><style>.a{fill:red}.b{/* */display:none}</style></defs>",
          ":2: style: ", "sets display is not read; save with presentation attributes"),
      svg("NegativeRadius", "<circle r='-1'/>", ":2: circle: r: \"-1\"", "is not >= 0"),
      svg("RectangleOfNoSize", "<rect width='0' height='2'/>", ":2: rect: ", "draws nothing"),
      svg("PercentOfNoPage", "<line x2='50%'/>",
          ":2: line: x2: ", "is a part of a page whose size the file does not tell"),
      svg("UseOfAnotherFile", "<use href='../secret.svg#a'/>",
          ":2: use: href: ", "is not #id, an element of this file; nothing else is read"),
      svg("UseOfTheNetwork", "<use xlink:href='http://127.0.0.1/a.svg#a'/>",
          ":2: use: ", "nothing else is read"),
      svg("UseOfNothing", "<use href='#a'/>", ":2: use: href: \"#a\"",
          "is no element of this file"),
      svg("UseOfItself", "<g id='a'><use href='#a'/></g>", ":2: ", "nested more than 200 deep"),
      svg("UseBomb", bombs, ": ", "draws more than 1000000 elements"),
  };
  return all;
}

class MalformedDrawing : public Program, public testing::WithParamInterface<BadDrawing> {};

TEST_P(MalformedDrawing, IsRefusedInOneLineThatSaysWhereAndWhyAndTouchesNoOutput) {
  const BadDrawing& bad = GetParam();
  const std::string file = in_folder(bad.file).string();
  std::string text = bad.text;
  if (bad.many.count > 0) text.replace(text.find('@'), 1, repeated(bad.many.text, bad.many.count));
  write_text(file, text);
  write_text(in_folder("secret.txt"), "M0 0L1 1");
  write_text(output("result.json"), "precious");

  const std::string curve = file + bad.curve;
  const Outcome run = nuno({"throw", curve, curve, "--time", "1", "--out", output("result.json")});
  expect_refusal(run, file + bad.place, "", bad.rule);
  EXPECT_EQ(read_text(output("result.json")), "precious");
  EXPECT_EQ(outputs(), std::set<std::string>{"result.json"});

  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  EXPECT_LE(usage.ru_maxrss, 1 << 20) << "KiB, of the largest";
}

INSTANTIATE_TEST_SUITE_P(EachOf, MalformedDrawing, testing::ValuesIn(bad_drawings()),
                         [](const auto& bad) { return bad.param.name; });

class ThrowOfDrawings : public Program {
 protected:
  /// What the flight begins and ends on, with its other arguments.
  Json thrown(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "throw");
    arguments.insert(arguments.end(), {"--time", "1"});
    return simulated(arguments);
  }
};

TEST_F(ThrowOfDrawings, TakesOneFileWithTwoPathsOfAllKinds) {
  const std::string svg = in_folder("shot.svg").string();
  write_text(svg,
             "<svg width='4000mm' height='2000mm' viewBox='0 0 4000 2000'>"
             "<path id='initial' d='M100 1000h1000'/>"
             "<g id='target'><path d='M3000 900q500 200 1000 0'/></g><rect width='1'/></svg>");
  const std::string obj = in_folder("shot.obj").string();
  write_text(obj,
             "o initial\nv 0.1 1 0\nv 1.1 1 0\nl 1 2\no target\nv 3 1.1 0\nv 3.5 1 0\n"
             "v 4 1.1 0\nl 3 4 5\n");
  for (const std::string& file : {svg, obj}) {
    const Json flight = thrown({file});
    EXPECT_EQ(flight["scene"], "shot");
    const Json start = flight["frames"]["positions"][0];
    EXPECT_NEAR(start[0][0], 0.1, 1e-12);
    EXPECT_NEAR(start[0][1], 1.0, 1e-12);
    EXPECT_NEAR(start.back()[0], 1.1, 1e-12);
    EXPECT_LT(flight["error"]["relative"], 0.01);
  }
}

TEST_F(ThrowOfDrawings, TakesTwoFilesOfDifferentKindsOnEitherEngine) {
  const std::string start = in_folder("start.csv").string();
  const std::string target = in_folder("target.svg").string();
  write_text(start, "x,y\n0,1\n1,1\n");
  write_text(target,
             "<svg width='2000mm' height='2000mm' viewBox='0 0 2 2'>"
             "<path id='a' d='M.5.5q.5.5 1 0'/><path id='b' d='M0 0'/></svg>");
  for (const std::string backend : {"native", "box2d"}) {
    const Json flight = thrown({start, target + "#a", "--backend", backend});
    EXPECT_EQ(flight["scene"], "target");
    EXPECT_EQ(flight["backend"], backend);
    EXPECT_LT(flight["error"]["relative"], 0.02);
  }
}

TEST_F(ThrowOfDrawings, AreRefusedWhatBelongsToMeshes) {
  const std::string line = in_folder("a.csv").string();
  write_text(line, "0,1\n1,1\n");
  const std::string mesh = in_folder("a.obj").string();
  write_text(mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto refusal = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "throw");
    arguments.insert(arguments.end(), {"--time", "1"});
    const Outcome run = nuno(arguments);
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(is_one_line(run.err)) << run.err;
    return run.err;
  };
  EXPECT_EQ(refusal({line, line, "--material", "silk"}),
            "--material: silk is a cloth of meshes, and " + line + " is a drawn line\n");
  EXPECT_NE(refusal({line, line, "--backend", "bullet"}).find("bullet does not fly a chain"),
            std::string::npos);
  EXPECT_NE(refusal({mesh, mesh, "--backend", "box2d"}).find("box2d does not fly a sheet"),
            std::string::npos);
  EXPECT_EQ(refusal({mesh}),
            "TARGET: is missing; a START of glTF can hold it as a morph target, a drawing as a "
            "line\n");
  EXPECT_NE(refusal({line, mesh}).find(mesh), std::string::npos);
}

}  // namespace
}  // namespace nuno
