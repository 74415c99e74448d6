// The parts of which pictures are made.

#include "pictures/plot.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pictures/drawn_result.h"
#include "pictures/flight_figure.h"
#include "pictures/summary.h"

namespace nuno::figures {
namespace {

std::vector<std::string> labels(const Axis& axis, int count) {
  std::vector<std::string> result;
  for (const Tick& tick : ticks(axis, count)) result.push_back(tick.label);
  return result;
}

using Labels = std::vector<std::string>;

TEST(Ticks, AreRoundAndAboutAsManyAsWished) {
  EXPECT_EQ(labels({"", 0, 10}, 10),
            (Labels{"0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10"}));
  EXPECT_EQ(labels({"", 0, 10}, 5), (Labels{"0", "2", "4", "6", "8", "10"}));
  EXPECT_EQ(labels({"", 0, 10}, 3), (Labels{"0", "2", "4", "6", "8", "10"}));
  EXPECT_EQ(labels({"", 0, 10}, 2), (Labels{"0", "5", "10"}));
  EXPECT_EQ(labels({"", 0, 10}, 1), (Labels{"0", "10"}));
  EXPECT_EQ(labels({"", -0.3, 0.31}, 6),
            (Labels{"−0.3", "−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3"}));
  for (const Tick& tick : ticks({"", 0.13, 7.9}, 4)) {
    EXPECT_GE(tick.value, 0.13);
    EXPECT_LE(tick.value, 7.9);
    EXPECT_EQ(std::stod(tick.label), tick.value);
  }
}

TEST(Ticks, OfALogarithmicAxisArePowersOfTenWithTheirMultiplesBetween) {
  const Axis axis{"", 0.01, 1000, Scale::logarithmic};
  Labels named;
  int minor = 0;
  for (const Tick& tick : ticks(axis, 10)) {
    if (tick.label.empty()) {
      ++minor;
    } else {
      named.push_back(tick.label);
    }
  }
  EXPECT_EQ(named, (Labels{"0.01", "0.1", "1", "10", "100", "1000"}));
  EXPECT_EQ(minor, 5 * 8);
  EXPECT_EQ(labels({"", 1, 10, Scale::logarithmic}, 5),
            (Labels{"1", "2", "", "", "5", "", "", "", "", "10"}));
  EXPECT_EQ(ticks({"", 1e-7, 1e5, Scale::logarithmic}, 20).front().label, "10⁻⁷");
}

TEST(Shown, HasThreeDigitsAsPeopleWriteThem) {
  EXPECT_EQ(shown(0), "0");
  EXPECT_EQ(shown(12), "12");
  EXPECT_EQ(shown(0.018123), "0.0181");
  EXPECT_EQ(shown(-3.14159), "−3.14");
  EXPECT_EQ(shown(1.234e-5), "1.2·10⁻⁵");
  EXPECT_EQ(shown(-6.5e7), "−6.5·10⁷");
}

TEST(Plot, PutsItsRangesIntoItsFrame) {
  const Plot plot({100, 50, 200, 80}, {"", -1, 3}, {"", 0.01, 100, Scale::logarithmic});
  EXPECT_DOUBLE_EQ(plot.at(-1, 0.01).x, 100);
  EXPECT_DOUBLE_EQ(plot.at(-1, 0.01).y, 130);
  EXPECT_DOUBLE_EQ(plot.at(3, 100).x, 300);
  EXPECT_DOUBLE_EQ(plot.at(3, 100).y, 50);
  EXPECT_DOUBLE_EQ(plot.at(1, 1).x, 200);
  EXPECT_DOUBLE_EQ(plot.at(1, 1).y, 90);
}

TEST(Plot, WithEqualScalesHoldsBothRangesAboutTheirMiddles) {
  for (const double width : {100.0, 400.0}) {
    const Plot plot = Plot::with_equal_scales({10, 20, width, 100}, {"", 1, 3}, {"", -2, 2});
    const Vec origin = plot.at(0, 0), along = plot.at(1, 0), up = plot.at(0, 1);
    EXPECT_NEAR(along.x - origin.x, origin.y - up.y, 1e-9);
    EXPECT_LE(plot.x().low, 1);
    EXPECT_GE(plot.x().high, 3);
    EXPECT_LE(plot.y().low, -2);
    EXPECT_GE(plot.y().high, 2);
    EXPECT_DOUBLE_EQ(plot.at(2, 0).x, 10 + width / 2);
    EXPECT_DOUBLE_EQ(plot.at(2, 0).y, 70);
  }
}

TEST(Flight, IsBetweenItsFramesOnTheStraightWay) {
  Flight flight;
  flight.times = {0, 1, 3};
  flight.positions = {Points{{0, 0}, {0, 1}}, Points{{1, 1}, {0, 1}}, Points{{5, 5}, {2, 3}}};
  EXPECT_EQ(positions_at(flight, -1), flight.positions.front());
  EXPECT_EQ(positions_at(flight, 0.25), (Points{{0.25, 0.25}, {0, 1}}));
  EXPECT_EQ(positions_at(flight, 1), flight.positions[1]);
  EXPECT_EQ(positions_at(flight, 2), (Points{{3, 3}, {1, 2}}));
  EXPECT_EQ(positions_at(flight, 7), flight.positions.back());
}

TEST(Stroke, GoesOverEveryEdgeAndNoOther) {
  Edges edges(2, 5);  // a square with a tail
  edges << 0, 1, 2, 0, 2, 1, 2, 3, 3, 4;
  const std::vector<Index> stroke = stroke_along(edges);
  EXPECT_EQ(stroke.front(), 0);
  std::vector<int> seen(5, 0);
  for (std::size_t i = 1; i < stroke.size(); ++i) {
    const auto [a, b] = std::minmax(stroke[i - 1], stroke[i]);
    bool known = false;
    for (Index e = 0; e < 5; ++e) {
      if (edges(0, e) == a && edges(1, e) == b) {
        ++seen[static_cast<std::size_t>(e)];
        known = true;
      }
    }
    EXPECT_TRUE(known) << a << ' ' << b;
  }
  for (const int times : seen) EXPECT_GE(times, 1);
}

TEST(ReadResult, NamesAFaceOfAVertexThatIsNotThere) {
  const std::string path = "sheet.json";
  const auto complaint = [&](const std::string& corner) -> std::string {
    const std::string text =
        R"({"nuno_result": 1, "kind": "sheet", "scene": "s", "backend": "native",
      "alpha": 1, "size": 1, "error": {"mean": 0, "max": 0}, "target": [[0,0,0],[1,0,0],[0,0,1]],
      "final": [[0,0,0],[1,0,0],[0,0,1]], "faces": [[0, 1, )" +
        corner + R"(]], "frames": {"times": [0, 1],
      "positions": [[[0,0,0],[1,0,0],[0,0,1]], [[0,0,0],[1,0,0],[0,0,1]]]}})";
    try {
      EXPECT_EQ(parse_result(text, path).positions.size(), 2u);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint("2"), "");
  for (const std::string corner : {"3", "-1", "1.5"}) {
    EXPECT_EQ(complaint(corner),
              path + ": /faces/0/2: " + corner + " is not a whole number within 0 … 2");
  }
}

TEST(Duration, IsInTheUnitThatAPersonReads) {
  EXPECT_EQ(duration(4.1e-3), "4.1 ms");
  EXPECT_EQ(duration(1.25), "1.25 s");
  EXPECT_EQ(duration(59e-6), "59 µs");
  EXPECT_EQ(duration(119), "119 s");
  EXPECT_EQ(duration(200.7), "3 min 20 s");
  EXPECT_EQ(duration(3605), "60 min 5 s");
}

}  // namespace
}  // namespace nuno::figures
