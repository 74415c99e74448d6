// Where a sheet passes through itself: counts that can be told beforehand.

#include <nuno/crossings.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sheets.h"

namespace nuno {
namespace {

/// A level square at y = 0 and an upright one at x = 0.25, with its lower edge at `bottom`.
Points two_squares(double bottom) {
  Points shape(3, 8);
  shape.leftCols(4) << -1, 1, 1, -1,  //
      0, 0, 0, 0,                     //
      -1, -1, 1, 1;
  shape.rightCols(4) << 0.25, 0.25, 0.25, 0.25,  //
      bottom, bottom + 1, bottom + 1, bottom,    //
      -0.5, -0.5, 0.5, 0.5;
  return shape;
}
const Faces two_faces = {{0, 1, 2, 3}, {4, 5, 6, 7}};

/// A strip whose profile is this polyline in x and y, `rows` cells wide.
Mesh strip(const Points& profile, Index rows) {
  Mesh mesh = grid(profile.cols(), rows + 1, 1);
  for (Index i = 0; i < mesh.vertices.cols(); ++i) {
    mesh.vertices.col(i).head<2>() = profile.col(i % profile.cols());
    mesh.vertices(2, i) = static_cast<double>(i / profile.cols());
  }
  return mesh;
}

// They meet along x = 0.25, y = 0, −0.5 < z < 0.5, which one diagonal cuts at z = 0.25 and the
// other at z = −0.2: three pieces, a pair of triangles each.
TEST(Crossings, TwoCrossingSquaresAreThreePairsOfTriangles) {
  const std::vector<Crossing> found = crossings(two_squares(-0.3), two_faces);
  ASSERT_EQ(found.size(), 3U);
  for (const Crossing& each : found) EXPECT_EQ(each.faces, (std::array<Index, 2>{0, 1}));
  // The upright one reaches 0.3 below the level one, which reaches 0.75 beyond it.
  double deepest = 0;
  for (const Crossing& each : found) deepest = std::max(deepest, each.depth);
  EXPECT_NEAR(deepest, 0.3, 1e-15);
}

TEST(Crossings, WhatOnlyTouchesDoesNotCross) {
  EXPECT_TRUE(crossings(two_squares(0), two_faces).empty());
  EXPECT_TRUE(crossings(two_squares(0.1), two_faces).empty());
}

// A loop: in each row of cells the first crosses the last along a line, which their diagonals cut
// at two places.
TEST(Crossings, ALoopCrossesItselfThreeTimesInEachRow) {
  const Points loop{{0, 1, 1, 0}, {0, 1, 0.2, 0.7}};
  const auto found = crossings(strip(loop, 5).vertices, strip(loop, 5).faces);
  EXPECT_EQ(found.size(), 15U);
}

TEST(Crossings, AFoldUponItselfDoesNotCross) {
  const Points fold{{0, 1, 2, 1, 0}, {0, 0, 0, 0, 0}};
  const Mesh mesh = strip(fold, 4);
  EXPECT_TRUE(crossings(mesh.vertices, mesh.faces).empty());
}

// Beyond one turn a roll's end would lie upon its beginning; its radius shrinks a little, so that
// the two are apart, and where it widens again they cross.
TEST(Crossings, ARollCrossesItselfWhereItsEndGoesThroughItsBeginning) {
  const Mesh flat = grid(33, 9, 0.1, Tiles::mixed);
  const auto rolled_by = [&](double turns, double wave) {
    Points shape = rolled(flat.vertices, 2 * std::numbers::pi * turns);
    const double radius = 3.2 / (2 * std::numbers::pi * turns);
    shape.row(1).array() -= radius;  // about its axis
    for (Index i = 0; i < shape.cols(); ++i) {
      const double along = flat.vertices(0, i) / 1.6;  // −1 … 1
      shape.col(i).head<2>() *= 1 + 0.1 * along + wave * along * along * along;
    }
    return crossings(shape, flat.faces);
  };
  EXPECT_TRUE(rolled_by(0.9, 0).empty());
  EXPECT_TRUE(rolled_by(1.4, 0).empty());
  // 0.1·x + wave·x³ is the same a whole turn apart: the spiral goes through itself.
  EXPECT_FALSE(rolled_by(1.4, -0.2).empty());
}

/// Every pair, one after another, of the same triangles in another order.
TEST(Crossings, DoNotDependOnTheOrderOfTheFaces) {
  const Points loop{{0, 0.5, 1, 1, 0.5, 0}, {0, 0.4, 1, 0.2, 0.35, 0.7}};
  Mesh mesh = strip(loop, 40);
  const auto found = crossings(mesh.vertices, mesh.faces);
  Faces backwards(mesh.faces.rbegin(), mesh.faces.rend());
  const auto again = crossings(mesh.vertices, backwards);
  EXPECT_EQ(found.size(), again.size());
  EXPECT_GE(found.size(), 40U * 3);
}

TEST(Crossings, AreToldOfTheFramesThatHaveThem) {
  const std::vector<double> times = {0, 0.5, 1, 1.5};
  const std::vector<Points> frames = {two_squares(0.5), two_squares(-0.1), two_squares(-0.4),
                                      two_squares(1)};
  const FlightCrossings told = flight_crossings(times, frames, two_faces, -0.25);
  EXPECT_EQ(told.frames, 4);
  EXPECT_EQ(told.crossed_frames, 2);
  EXPECT_EQ(told.most_pairs, 3);
  EXPECT_EQ(told.first_time, 0.5);
  EXPECT_EQ(told.deepest_time, 1);
  EXPECT_NEAR(told.depth, 0.4, 1e-15);
  EXPECT_EQ(told.grounded_frames, 1);
  EXPECT_EQ(told.ground_time, 1);
  EXPECT_NEAR(told.ground_depth, 0.15, 1e-15);
}

TEST(Crossings, TheGroundIsLevelZeroUnlessAShapeIsDrawnBelow) {
  EXPECT_EQ(ground_height(two_squares(2), two_squares(3)), 0);
  EXPECT_EQ(ground_height(two_squares(-0.5), two_squares(3)), -0.5);
}

}  // namespace
}  // namespace nuno
