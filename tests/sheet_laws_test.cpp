// What a sheet is made of, on meshes on which every number can be told.

#include <nuno/sheet.h>
#include <nuno/sheet_morph.h>

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace nuno {
namespace {

const SheetMaterial material = {.areal_density = 0.2,
                                .air_drag = 0.03,
                                .stretch_stiffness = 300,
                                .stretch_damping = 0.006,
                                .shear_stiffness = 80,
                                .shear_damping = 0.002,
                                .bending_stiffness = 1e-3,
                                .bending_damping = 1e-5};

Sheet sheet_of(const Points& vertices, const Faces& faces, Rest rest = Rest::initial) {
  return make_sheet(vertices, faces, material, rest, 9.8);
}

using Pair = std::pair<Index, Index>;
std::map<Pair, double> by_ends(const Springs& springs, const Vector& values) {
  std::map<Pair, double> result;
  for (Index e = 0; e < springs.count(); ++e) {
    result[std::minmax(springs.ends(0, e), springs.ends(1, e))] += values[e];
  }
  return result;
}

/// Two squares of side 2 beside each other, and a triangle of half a square.
///     3 - 4 - 5
///     |   |   | \        y up is z here; vertex 6 at the right below
///     0 - 1 - 2 - 6
const Points strip{{0, 2, 4, 0, 2, 4, 6}, {0, 0, 0, 0, 0, 0, 0}, {0, 0, 0, -2, -2, -2, 0}};
const Faces strip_faces = {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 6, 5}};

TEST(SheetLaws, GiveAVertexAThirdOrAQuarterOfItsFaces) {
  const Sheet sheet = sheet_of(strip, strip_faces);
  const double total = 4 + 4 + 2;
  EXPECT_DOUBLE_EQ(sheet.size, std::sqrt(total));
  EXPECT_DOUBLE_EQ(sheet.particle_mass, 0.2 * total / 7);
  Vector areas(7);
  areas << 1, 2, 1 + 2.0 / 3, 1, 2, 1 + 2.0 / 3, 2.0 / 3;
  EXPECT_LT((sheet.relative_mass - areas * (7 / total)).norm(), 1e-14);
  EXPECT_DOUBLE_EQ(sheet.drag_rate, 0.03 / 0.2);
  EXPECT_DOUBLE_EQ(sheet.sound_speed, std::sqrt(300 / 0.2));
  EXPECT_EQ(sheet.gravity, 9.8);
}

// k = S·a/ℓ², a of whole triangles and half quads.
TEST(SheetLaws, StretchEdgesByTheAreaBesideThem) {
  const Sheet sheet = sheet_of(strip, strip_faces);
  ASSERT_EQ(sheet.stretch.count(), 9);
  std::map<Pair, double> shapes = {{{0, 1}, 2.0 / 4}, {{0, 3}, 2.0 / 4}, {{3, 4}, 2.0 / 4},
                                   {{1, 4}, 4.0 / 4}, {{1, 2}, 2.0 / 4}, {{4, 5}, 2.0 / 4},
                                   {{2, 5}, 4.0 / 4}, {{2, 6}, 2.0 / 4}, {{5, 6}, 2.0 / 8}};
  const auto stiffness = by_ends(sheet.stretch, sheet.stretch.stiffness);
  const auto damping = by_ends(sheet.stretch, sheet.stretch.damping);
  for (const auto& [ends, shape] : shapes) {
    EXPECT_NEAR(stiffness.at(ends), 300 * shape, 1e-12);
    EXPECT_NEAR(damping.at(ends), 0.006 * shape, 1e-15);
  }
  EXPECT_DOUBLE_EQ(by_ends(sheet.stretch, sheet.stretch.rest_length).at({5, 6}), std::sqrt(8));
  EXPECT_EQ(sheet.edges, sheet.stretch.ends);
  EXPECT_EQ(sheet.rest_length, sheet.stretch.rest_length);
}

TEST(SheetLaws, ShearQuadsAlongBothDiagonalsByHalfTheStiffnessEach) {
  const Sheet sheet = sheet_of(strip, strip_faces);
  ASSERT_EQ(sheet.shear.count(), 4);  // a triangle has none
  for (const Pair& ends : {Pair{0, 4}, {1, 3}, {1, 5}, {2, 4}}) {
    EXPECT_NEAR(by_ends(sheet.shear, sheet.shear.stiffness).at(ends), 40, 1e-12);
    EXPECT_NEAR(by_ends(sheet.shear, sheet.shear.damping).at(ends), 0.001, 1e-15);
    EXPECT_DOUBLE_EQ(by_ends(sheet.shear, sheet.shear.rest_length).at(ends), std::sqrt(8));
  }
}

/// Two equilateral triangles of side 2 at an edge along z, the second one folded up by `angle`.
Points folded(double angle) {
  const double height = std::sqrt(3);
  return Points{{0, 0, -height, height * std::cos(angle)},
                {0, 0, 0, height * std::sin(angle)},
                {1, -1, 0, 0}};
}
const Faces two_triangles = {{0, 1, 2}, {1, 0, 3}};

TEST(SheetLaws, BendAnEdgeOfTwoTrianglesByItsLengthAndTheirArea) {
  const Sheet sheet = sheet_of(folded(0.3), two_triangles);
  ASSERT_EQ(sheet.hinges.count(), 1);
  const double shape = 3 * 4 / (2 * std::sqrt(3));  // 3·|e|²/(A₀ + A₁)
  EXPECT_NEAR(sheet.hinges.stiffness[0], 1e-3 * shape, 1e-15);
  EXPECT_NEAR(sheet.hinges.damping[0], 1e-5 * shape, 1e-17);
  EXPECT_NEAR(std::abs(sheet.hinges.rest_angle[0]), 0.3, 1e-14);
  const Sheet flat = sheet_of(folded(0.3), two_triangles, Rest::flat);
  EXPECT_EQ(flat.hinges.rest_angle[0], 0);
}

TEST(SheetLaws, BendTheOtherWayByTheOtherSign) {
  const auto rest = [](double angle) {
    return sheet_of(folded(angle), two_triangles).hinges.rest_angle[0];
  };
  EXPECT_NEAR(rest(0.3) + rest(-0.3), 0, 1e-14);
  EXPECT_NEAR(std::abs(rest(3)), 3, 1e-14);
}

// A square grid rolled about any axis has the energy ½·3·B·κ² per area: about an edge, by the
// hinges there, and about a diagonal.
TEST(SheetLaws, BendASquareGridAlikeAboutEveryAxis) {
  constexpr Index n = 21;
  Points flat(3, n * n);
  Faces faces;
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      flat.col(j * n + i) << static_cast<double>(i), 0, static_cast<double>(-j);
      if (i + 1 < n && j + 1 < n) {
        const Index a = j * n + i;
        faces.push_back({a, a + 1, a + n + 1, a + n});
      }
    }
  }
  const Sheet sheet = sheet_of(flat, faces);
  constexpr double curvature = 1e-3;
  for (const double axis : {0.0, 0.3, std::numbers::pi / 4}) {
    Points rolled = flat;
    for (Index i = 0; i < flat.cols(); ++i) {
      const double along = std::cos(axis) * flat(0, i) + std::sin(axis) * flat(2, i);
      rolled(1, i) = curvature / 2 * along * along;
    }
    // The hinges of an area of 11 × 11 that is half open: as many of each kind as of faces.
    constexpr double middle = (n - 1) / 2.0, reach = 5.5;
    const auto is_within = [&](double along) { return along >= -reach && along < reach; };
    double energy = 0;
    for (Index h = 0; h < sheet.hinges.count(); ++h) {
      const auto corners = sheet.hinges.corners.col(h);
      const Eigen::Vector3d at = 0.5 * (flat.col(corners[0]) + flat.col(corners[1]));
      if (!is_within(at.x() - middle) || !is_within(at.z() + middle)) continue;
      energy += 0.5 * sheet.hinges.stiffness[h] * std::pow(dihedral_angle(rolled, corners), 2);
    }
    const double per_area = energy / std::pow(2 * reach, 2);
    const double expected = 0.5 * 3 * material.bending_stiffness * curvature * curvature;
    EXPECT_NEAR(per_area / expected, 1, 1e-3) << axis;  // slopes of up to 0.02, squared
  }
}

// Stretch goes linearly on the way, so that a sheet that is drawn out grows steadily.
TEST(SheetLaws, DrawASheetOutAtASteadyRate) {
  Problem problem;
  problem.form = sheet_of(strip, strip_faces);
  problem.target = 1.5 * strip;
  problem.target.row(0) *= 0.6;  // one way; the other way it gets narrower
  problem.arrival_time = 1;
  problem.reference = Reference::morph;
  const Points from = problem.cloth().shape_of(strip);
  const Points to = problem.cloth().shape_of(problem.target);
  SheetMorph morph(problem, 1.0 / 50);
  for (Index n = 0; n <= 50; ++n) {
    const double s = static_cast<double>(n) / 50;
    EXPECT_LT((morph.shape() - (1 - s) * from - s * to).norm(), 1e-10) << s;
    morph.advance();
  }
}

}  // namespace
}  // namespace nuno
