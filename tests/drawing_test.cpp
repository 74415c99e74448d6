// Drawings: SVG's grammar, transforms and units against closed forms, OBJ lines, CSV.

#include <gtest/gtest.h>

#include <nuno/drawing.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace nuno {
namespace {

using std::numbers::pi;
constexpr double px = 0.0254 / 96;  // [m]
constexpr double rounding = 1e-12;  // of numbers about 1, after a few operations

/// A document without a page, 1 unit to the metre after a division by px, y still down.
Points in_units(const std::string& elements, const std::string& name = "") {
  Points points = parse_svg("<svg>" + elements + "</svg>", "test.svg", name) / px;
  points.row(1) *= -1;
  return points;
}

Points path(const std::string& d) { return in_units("<path d='" + d + "'/>"); }

double length(const Points& points) { return segment_lengths(points).sum(); }

std::string refusal(const std::string& elements, const std::string& name = "") {
  try {
    in_units(elements, name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

#define EXPECT_POINTS(points, ...)                                         \
  do {                                                                     \
    const Points are = points, wanted = Points{__VA_ARGS__};               \
    ASSERT_EQ(are.cols(), wanted.cols()) << are;                           \
    EXPECT_LT((are - wanted).norm(), rounding*(1 + wanted.norm())) << are; \
  } while (false)

TEST(SvgPath, LinesAreAbsoluteOrRelativeAndRepeatWithoutTheirLetter) {
  EXPECT_POINTS(path("M1 2L3 4"), {1, 3}, {2, 4});
  EXPECT_POINTS(path("m1 2 3 4 5 6"), {1, 4, 9}, {2, 6, 12});
  EXPECT_POINTS(path("M1 2 3 4 5 6"), {1, 3, 5}, {2, 4, 6});
  EXPECT_POINTS(path("M1,2h3 4v-1-2H0V0"), {1, 4, 8, 8, 8, 0, 0}, {2, 2, 2, 1, -1, -1, 0});
  EXPECT_POINTS(path("M 1 2 m 1 1 l 1 0"), {2, 3}, {3, 3});
}

TEST(SvgPath, NumbersNeedNoSeparatorsWhereTheyCannotRunTogether) {
  EXPECT_POINTS(path("M1.5.5-2-.25"), {1.5, -2}, {0.5, -0.25});
  EXPECT_POINTS(path("M+1e1-1E-1L1.e0,.5e+1"), {10, 1}, {-0.1, 5});
  EXPECT_POINTS(path("\n M\t1 ,2 \r\n\f3 , 4 "), {1, 3}, {2, 4});
  // Flags are one digit each: of radii 1, no rotation, large 0, clockwise 1, to (1.5, 0.5).
  const Points glued = path("M0 0a1 1 0 011.5.5"), apart = path("M0 0a1 1 0 0 1 1.5 0.5");
  EXPECT_EQ(glued, apart);
  EXPECT_EQ(glued(0, glued.cols() - 1), 1.5);
  EXPECT_EQ(path("M0 0a1,1,0,0,1,1.5,.5"), apart);
}

TEST(SvgPath, AClosedOneEndsWhereItBegan) {
  EXPECT_POINTS(path("M1 1h2v2z"), {1, 3, 3, 1}, {1, 1, 3, 1});
  EXPECT_POINTS(path("M1 1h2v2H1V1Z"), {1, 3, 3, 1, 1}, {1, 1, 3, 3, 1});
}

TEST(SvgPath, ASmoothCommandMirrorsTheControlPointOfItsOwnKindAlone) {
  EXPECT_EQ(path("M0 0C0 1 2 3 4 0S7 1 8 0"), path("M0 0C0 1 2 3 4 0C6 -3 7 1 8 0"));
  EXPECT_EQ(path("M0 0c0 1 2 3 4 0s3 1 4 0"), path("M0 0C0 1 2 3 4 0S7 1 8 0"));
  EXPECT_EQ(path("M0 0Q1 3 2 0T4 0"), path("M0 0Q1 3 2 0Q3 -3 4 0"));
  EXPECT_EQ(path("M0 0q1 3 2 0t2 0 2 0"), path("M0 0Q1 3 2 0Q3 -3 4 0Q5 3 6 0"));
  EXPECT_EQ(path("M0 0Q1 3 2 0S3 1 4 0"), path("M0 0Q1 3 2 0C2 0 3 1 4 0"));
  EXPECT_EQ(path("M0 0C0 1 1 3 2 0T4 1"), path("M0 0C0 1 1 3 2 0Q2 0 4 1"));
}

// A parabola's and a cubic's own equations; chords deviate by the tolerance, vertices do not.
TEST(SvgPath, BeziersAreWhereTheirPolynomialsAre) {
  const Points parabola = path("M-1 1Q0 -1 1 1");  // y = x²
  for (const auto& p : parabola.colwise()) EXPECT_NEAR(p.y(), p.x() * p.x(), rounding);
  EXPECT_NEAR(length(parabola), std::sqrt(5) + std::asinh(2) / 2, 1e-5);
  const Points cubic = path("M0 0C1 0 2 0 3 27");  // y = x³
  for (const auto& p : cubic.colwise()) EXPECT_NEAR(p.y(), std::pow(p.x(), 3), 27 * rounding);
}

TEST(SvgPath, ChordsAreNoFartherFromTheCurveThanTheTolerance) {
  const Points arc = path("M1 0A1 1 0 0 1 -1 0");
  const double most = 1e-6 * pi;
  double worst = 0;
  for (Index i = 1; i < arc.cols(); ++i) {
    worst = std::max(worst, 1 - (arc.col(i) + arc.col(i - 1)).norm() / 2);
  }
  EXPECT_LE(worst, most);
  EXPECT_GT(worst, most / 4) << "more chords than needed";
}

TEST(SvgArc, FlagsChooseOneOfFour) {
  // Of radius 1 from (0, 0) to (1, 1): a quarter or three quarters. From (0, 0), clockwise on the
  // page about (0, 1) leads to (1, 1) at once, about (1, 0) only after three quarters.
  struct Case {
    const char* flags;
    double x, y, turn;
  };
  for (const Case& c : {Case{"0 1", 0, 1, 0.25}, Case{"0 0", 1, 0, 0.25}, Case{"1 1", 1, 0, 0.75},
                        Case{"1 0", 0, 1, 0.75}}) {
    const Points arc = path("M0 0A1 1 0 " + std::string(c.flags) + " 1 1");
    for (const auto& p : arc.colwise()) {
      EXPECT_NEAR(std::hypot(p.x() - c.x, p.y() - c.y), 1, rounding) << c.flags;
    }
    EXPECT_NEAR(length(arc), 2 * pi * c.turn, 2e-5) << c.flags;
  }
}

TEST(SvgArc, RadiiThatAreTooSmallGrowUntilTheyReach) {
  for (const char* radii : {"1 1", "-1 1", "1e-6 1e-6", "2 2"}) {
    const Points arc = path("M0 0A" + std::string(radii) + " 0 0 1 4 0");
    for (const auto& p : arc.colwise()) {
      EXPECT_NEAR(std::hypot(p.x() - 2, p.y()), 2, 1e-9) << radii;
      EXPECT_LE(p.y(), 1e-9) << "clockwise from the left is over the top";
    }
  }
  const Points ellipse = path("M0 0A1 2 0 0 1 4 0");  // half axes 2 and 4
  EXPECT_NEAR(ellipse.row(1).minCoeff(), -4, 1e-3);
}

TEST(SvgArc, OfNoRadiusIsALineAndToItsOwnStartNothing) {
  EXPECT_POINTS(path("M0 0A0 1 0 0 1 4 0"), {0, 4}, {0, 0});
  EXPECT_POINTS(path("M0 0A1 1 0 0 1 0 0L1 0"), {0, 1}, {0, 0});
}

TEST(SvgArc, TurnsWithItsAxes) {
  const double c = std::cos(pi / 6), s = std::sin(pi / 6);
  const Points arc = path("M3 0A3 1 30 1 1 3 1");
  // In the frame of the half axes all points are on one circle of radius 1, about the point that is
  // as far from the ends as from the middle.
  Points circle(2, arc.cols());
  circle.row(0) = (c * arc.row(0) + s * arc.row(1)) / 3;
  circle.row(1) = c * arc.row(1) - s * arc.row(0);
  const Eigen::Vector2d chord = (circle.rightCols(1) - circle.leftCols(1)) / 2;
  const Eigen::Vector2d across(-chord.y(), chord.x());
  const double off =
      std::sqrt(1 / chord.squaredNorm() - 1);  // large and clockwise: on its other side
  const Eigen::Vector2d middle = circle.col(0) + chord - off * across;
  for (const auto& p : circle.colwise()) EXPECT_NEAR((p - middle).norm(), 1, 1e-11);
}

TEST(SvgShapes, AreTheirClosedForms) {
  EXPECT_POINTS(in_units("<line x1='1' y1='2' x2='3'/>"), {1, 3}, {2, 0});
  EXPECT_POINTS(in_units("<polyline points='1,2 3,4-5-6'/>"), {1, 3, -5}, {2, 4, -6});
  EXPECT_POINTS(in_units("<polygon points='0 0 1 0 1 1'/>"), {0, 1, 1, 0}, {0, 0, 1, 0});
  EXPECT_POINTS(in_units("<rect x='1' y='2' width='3' height='4'/>"), {1, 4, 4, 1, 1},
                {2, 2, 6, 6, 2});
  EXPECT_NEAR(length(in_units("<circle cx='5' cy='6' r='2'/>")), 4 * pi, 1e-4);
  const Points ellipse = in_units("<ellipse cx='1' rx='3' ry='2'/>");
  for (const auto& p : ellipse.colwise()) {
    EXPECT_NEAR(std::hypot((p.x() - 1) / 3, p.y() / 2), 1, rounding);
  }
  EXPECT_POINTS(ellipse.leftCols(1), {4}, {0});
  EXPECT_NEAR(length(in_units("<rect width='10' height='6' rx='2'/>")), 32 - 16 + 4 * pi, 1e-4);
  // Radii end at half the side: two quarters of an ellipse on every side.
  EXPECT_EQ(in_units("<rect width='10' height='6' rx='9' ry='9'/>"),
            in_units("<rect width='10' height='6' rx='5' ry='3'/>"));
}

TEST(SvgTransform, ApplyFromRightToLeft) {
  const auto line = [](const std::string& transform) {
    return in_units("<line x2='1' y2='2' transform='" + transform + "'/>");
  };
  EXPECT_POINTS(line("translate(3)"), {3, 4}, {0, 2});
  EXPECT_POINTS(line("translate(3,4)scale(2)"), {3, 5}, {4, 8});
  EXPECT_POINTS(line("scale(2 3) , translate(3-4)"), {6, 8}, {-12, -6});
  EXPECT_POINTS(line("rotate(90)"), {0, -2}, {0, 1});
  EXPECT_POINTS(line("rotate(180 1 1)"), {2, 1}, {2, 0});
  EXPECT_POINTS(line("skewX(45)"), {0, 3}, {0, 2});
  EXPECT_POINTS(line("skewY(45)"), {0, 1}, {0, 3});
  EXPECT_POINTS(line(" matrix( 1 2 3 4 5 6 ) "), {5, 12}, {6, 16});
  EXPECT_POINTS(
      in_units("<g transform='translate(1)'><g transform='scale(2)'><line x2='1'/></g></g>"),
      {1, 3}, {0, 0});
}

TEST(SvgTransform, SkewsArcsExactly) {
  const Points points = in_units("<circle r='1' transform='matrix(2 0 1 1 0 0)'/>");
  for (const auto& p : points.colwise()) {
    EXPECT_NEAR(std::hypot((p.x() - p.y()) / 2, p.y()), 1, rounding);
  }
}

TEST(SvgPage, AMillimetreIsAMillimetreAndTheLowerLeftCornerTheOrigin) {
  const auto read = [](const std::string& attributes, const std::string& line) {
    return parse_svg("<svg " + attributes + "><line " + line + "/></svg>", "test.svg", "");
  };
  EXPECT_POINTS(
      read("width='200mm' height='100mm' viewBox='0 0 200 100'", "x1='10' x2='20' y2='90'"),
      {0.01, 0.02}, {0.1, 0.01});
  EXPECT_POINTS(read("width='200mm' height='100mm'", "x1='1mm' y1='100mm' x2='2cm' y2='50%'"),
                {0.001, 0.02}, {0, 0.05});
  EXPECT_POINTS(read("viewBox='0 0 96 96'", "y1='96' x2='1in' y2='72pt'"), {0, 0.0254}, {0, 0});
  EXPECT_POINTS(read("width='1in' viewBox='0 0 50 100'", "y1='100' x2='50'"), {0, 0.0254},
                {0, 0.0508});
  EXPECT_POINTS(read("width='6pc' height='101.6Q'", "x2='96px' y2='96'"), {0, 0.0254}, {0.0254, 0});
  EXPECT_POINTS(read("width='100%' height='100%' viewBox='0 0 96 96'", "x2='96' y2='96'"),
                {0, 0.0254}, {0.0254, 0});
  EXPECT_POINTS(read("width='2in' height='2in' viewBox='0 0 10 10'", "y1='100%' x2='50%' y2='10'"),
                {0, 0.0254}, {0, 0});
}

TEST(SvgPage, IsFittedAsItsAspectRatioAsks) {
  const auto read = [](const std::string& preserve) -> Points {
    Points points = parse_svg("<svg width='400' height='200' viewBox='10 20 100 100'" + preserve +
                                  "><line x1='10' y1='20' x2='110' y2='120'/></svg>",
                              "test.svg", "") /
                    px;
    points.row(1) = 200 - points.row(1).array();
    return points;
  };
  const auto with = [](const std::string& v) { return " preserveAspectRatio='" + v + "'"; };
  EXPECT_POINTS(read(""), {100, 300}, {0, 200});
  EXPECT_POINTS(read(with("xMinYMid")), {0, 200}, {0, 200});
  EXPECT_POINTS(read(with("xMaxYMax meet")), {200, 400}, {0, 200});
  EXPECT_POINTS(read(with("none")), {0, 400}, {0, 200});
  EXPECT_POINTS(read(with("xMidYMin slice")), {0, 400}, {0, 400});
  EXPECT_POINTS(read(with("xMidYMid slice")), {0, 400}, {-100, 300});
  EXPECT_POINTS(read(with("xMinYMax slice")), {0, 400}, {-200, 200});
}

TEST(SvgPage, NestedViewportsAndSymbolsHaveTheirOwnUnits) {
  EXPECT_POINTS(in_units("<svg x='10' y='20' width='50' height='50' viewBox='0 0 5 5'>"
                         "<line x2='50%' y2='5'/></svg>"),
                {10, 35}, {20, 70});
  EXPECT_POINTS(in_units("<symbol id='s' viewBox='0 0 5 5'><line x2='5' y2='5'/></symbol>"
                         "<use href='#s' x='10' width='50' height='50'/>"),
                {10, 60}, {0, 50});
  EXPECT_POINTS(in_units("<defs><g id='a' transform='scale(2)'><line x2='1'/></g></defs>"
                         "<use xlink:href='#a' x='1' y='2' transform='scale(3)'/>"),
                {3, 9}, {6, 6});
}

TEST(SvgNames, AreIdsAndLabelsAndThoseOfGroupsWithOneCurve) {
  const std::string lines =
      "<line id='a' x2='1'/><g id='b'><line x2='2'/></g><line inkscape:label='c' x2='3'/>"
      "<g id='d'><line x2='4'/><line id='e' x2='5'/></g><svg:g id='a'/>";
  EXPECT_DOUBLE_EQ(length(in_units(lines, "a")), 1);
  EXPECT_DOUBLE_EQ(length(in_units(lines, "b")), 2);
  EXPECT_DOUBLE_EQ(length(in_units(lines, "c")), 3);
  EXPECT_DOUBLE_EQ(length(in_units(lines, "e")), 5);
  EXPECT_EQ(refusal(lines, "d"),
            "test.svg: draws 2 paths named \"d\", not one; its paths: \"a\", \"c\", \"e\", …");
  EXPECT_NE(refusal(lines).find("test.svg: draws 5 paths; name one as"), std::string::npos);
  EXPECT_DOUBLE_EQ(
      length(in_units("<defs><line id='p' x2='7'/></defs><use id='u' href='#p'/>", "u")), 7);
}

TEST(SvgNames, WhatIsNotDisplayedIsNotDrawn) {
  for (const std::string hidden : {"display='none'", "style='fill:red; display : none'",
                                   "visibility='hidden'", "style='visibility:collapse'"}) {
    EXPECT_DOUBLE_EQ(length(in_units("<g " + hidden + "><line x2='2'/></g><line x2='1'/>")), 1)
        << hidden;
  }
  EXPECT_DOUBLE_EQ(
      length(in_units("<g visibility='hidden'><line x2='2' visibility='visible'/></g>")), 2);
  EXPECT_DOUBLE_EQ(length(in_units("<line x2='2'/><clipPath><rect width='1' height='1'/></clipPath>"
                                   "<path d=''/><text>1</text><image href='http://a/b.png'/>")),
                   2);
  EXPECT_DOUBLE_EQ(
      length(in_units("<switch><foreignObject requiredExtensions='x'/><g><line x2='2'/>"
                      "</g><line x2='3'/></switch>")),
      2);
}

TEST(SvgNames, WhatIsWrongWithOtherPathsDoesNotMatter) {
  const std::string bad =
      "<path id='bad' d='M0 0X'/><line transform='turn(1)'/><use href='other.svg#a'/>"
      "<path d='M0 0L1 1M2 2L3 3'/>";
  EXPECT_DOUBLE_EQ(length(in_units(bad + "<line id='good' x2='2'/>", "good")), 2);
  EXPECT_EQ(refusal(bad, "bad"),
            "test.svg:1: path \"bad\": d: \"X\" at character 5 is not a command of a path");
}

// Lines of OBJ

TEST(ObjCurve, IsOneInWhateverOrderItsSegmentsStand) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 3 1 0\n";
  const auto read = [&](const std::string& lines) {
    return parse_obj_curve(vertices + lines, "test.obj", "");
  };
  const Points wanted{{0, 1, 1, 3}, {0, 0, 1, 1}};
  EXPECT_EQ(read("l 1 2 3 4\n"), wanted);
  EXPECT_EQ(read("l 1/1 2/2 \\\n -2 -1 # all\n"), wanted);
  EXPECT_EQ(read("l 3 4\nl 2 3\nl 1 2\n"), wanted);
  EXPECT_EQ(read("l 1 2\nl 4 3\nl 3 2\n"), wanted);
  EXPECT_EQ(read("l 4 3 2 1\n"), wanted.rowwise().reverse());
  const Points closed{{0, 1, 1, 0}, {0, 0, 1, 0}};
  EXPECT_EQ(read("l 1 2\nl 2 3\nl 3 1\n"), closed);
}

TEST(ObjCurve, IsFoundByItsObjectsName) {
  const std::string text =
      "o initial\nv 0 0 2\nv 1 0 2\nl 1 2\no target\nv 0 5 2\nv 1 6 2\nl 3 4\no other\n";
  EXPECT_EQ(parse_obj_curve(text, "test.obj", "target"), (Points{{0, 1}, {5, 6}}));
  EXPECT_THROW(parse_obj_curve(text, "test.obj", ""), InputError);
  EXPECT_THROW(parse_obj_curve(text, "test.obj", "other"), InputError);
}

// Points of CSV

TEST(Csv, IsTwoNumbersALineWithWhateverTitle) {
  const Points wanted{{0, 1.5, -2}, {1, 2e-3, 3}};
  EXPECT_EQ(parse_csv("0,1\n1.5,2e-3\n-2,3\n", "a.csv"), wanted);
  EXPECT_EQ(parse_csv("\xEF\xBB\xBFx,y\r\n\r\n0;1\r\n 1.5 ; 2e-3\r\n-2;3", "a.csv"), wanted);
  EXPECT_EQ(parse_csv("# metres\nx y\n0 1\n1.5\t2e-3 # here\n-2 +3\n", "a.csv"), wanted);
}

}  // namespace
}  // namespace nuno
