#include <nuno/problem.h>
#include <nuno/sheet_morph.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "sheet_library.h"

namespace nuno {
namespace {

/// 3 × 3 vertices on 4 quads.
SheetScene square() {
  const scene_library::FlatMesh mesh = scene_library::grid(1, 1, 3, 3);
  SheetScene scene;
  scene.name = "square";
  scene.arrival_time = 1;
  scene.initial = mesh.vertices;
  scene.target = mesh.vertices;
  scene.faces = mesh.faces;
  return scene;
}

struct BadMesh {
  std::function<void(SheetScene&)> spoil;
  std::string message;
};

class MalformedSheet : public testing::TestWithParam<BadMesh> {};

TEST_P(MalformedSheet, IsRefusedWithFieldValueAndRule) {
  SheetScene scene = square();
  GetParam().spoil(scene);
  try {
    make_problem(scene, "bad.json");
    FAIL() << "accepted, not refused by " << GetParam().message;
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), "bad.json: " + GetParam().message);
  }
}

// Faces of the square: (0 3 4 1), (1 4 5 2), (3 6 7 4), (4 7 8 5).
INSTANTIATE_TEST_SUITE_P(
    Meshes, MalformedSheet,
    testing::Values(
        BadMesh{[](SheetScene& s) { s.faces.clear(); }, "/initial: 0 faces are not at least one"},
        BadMesh{[](SheetScene& s) { s.faces[1].resize(2); },
                "/initial/faces/1: 2 corners are not 3 or 4"},
        BadMesh{[](SheetScene& s) {
                  s.faces[1] = {0, 1, 2, 5, 4};
                },
                "/initial/faces/1: 5 corners are not 3 or 4"},
        BadMesh{[](SheetScene& s) { s.faces[2][3] = 9; },
                "/initial/faces/2: vertex 9 is not within 0 … 8"},
        BadMesh{[](SheetScene& s) { s.faces[2][3] = -1; },
                "/initial/faces/2: vertex -1 is not within 0 … 8"},
        BadMesh{[](SheetScene& s) { s.faces[0][3] = 3; },
                "/initial/faces/0: vertex 3 stands twice in the face"},
        BadMesh{[](SheetScene& s) { s.initial.col(4) = s.initial.col(1); },
                "/initial/faces/0: the edge from vertex 4 to 1 has no length"},
        BadMesh{
            [](SheetScene& s) {
              s.faces.push_back({0, 1, 2});
            },
            "/initial/faces/4: has no area at vertex 0, which lies on a line with its neighbours"},
        BadMesh{
            [](SheetScene& s) { s.initial.col(4) = 0.5 * (s.initial.col(1) + s.initial.col(3)); },
            "/initial/faces/0: has no area at vertex 4, which lies on a line with its neighbours"},
        BadMesh{[](SheetScene& s) {
                  s.initial.col(4) =
                      0.3 * (s.initial.col(1) + s.initial.col(3)) + 0.4 * s.initial.col(0);
                },
                "/initial/faces/0: is a quad that is not convex at vertex 4: two triangles can be"},
        BadMesh{[](SheetScene& s) { std::swap(s.faces[0][0], s.faces[0][1]); },
                "/initial/faces/0: is a quad that is not convex at vertex 3: two triangles can be"},
        BadMesh{[](SheetScene& s) {
                  s.faces.push_back({1, 4, 6});
                },
                "/initial/faces/4: is the third face at the edge from vertex 1 to 4; an edge has "
                "one or two"},
        BadMesh{[](SheetScene& s) { s.faces.pop_back(); },
                "/initial/vertices/8: the vertex is in no face"},
        BadMesh{
            [](SheetScene& s) {
              s.faces = {{0, 3, 1}, {2, 4, 5}, {6, 7, 4}, {8, 5, 7}};
            },
            "/initial: are separate sheets, not a single one: nothing holds vertex 2 to vertex 0"},
        BadMesh{[](SheetScene& s) { s.target.conservativeResize(3, 8); },
                "/target: 8 vertices are not the 9 of /initial"},
        BadMesh{[](SheetScene& s) { s.initial.conservativeResize(2, 9); },
                "/initial: vertices of 2 numbers have not 3"},
        BadMesh{[](SheetScene& s) { s.initial(1, 5) = std::nan(""); },
                "/initial/vertices/5: nan is not within ±1000000000000"},
        BadMesh{[](SheetScene& s) { s.target(2, 0) = -std::numeric_limits<double>::infinity(); },
                "/target/vertices/0: -inf is not within ±1000000000000"},
        BadMesh{[](SheetScene& s) { s.target.setZero(); },
                "/target: size 0 is not >= 1e-12 and 1e-09 of its distance from the origin"},
        BadMesh{[](SheetScene& s) { s.target = (0x1p-10 * s.target).array() + 0x1p31; },
                "/target: size 0.0013810679320049757 is not >= 1e-12 and 1e-09 of its distance "
                "from the origin"},
        BadMesh{[](SheetScene& s) { s.target.row(2).setZero(); },
                "/target: the mesh has no area to fit"},
        BadMesh{[](SheetScene& s) { s.cloth.areal_density = 0; },
                "/cloth/areal_density: 0 is not > 0"}));

TEST(SheetScene, MayHaveHolesAndTouchItselfAtAVertex) {
  SheetScene scene = square();
  scene.faces = {{0, 3, 4, 1}, {4, 7, 8, 5}, {1, 2, 5}, {3, 6, 7}};
  EXPECT_NO_THROW(make_problem(scene));
}

// Which way round a face runs changes no law: only the sign of an angle, at both ends alike.
TEST(SheetScene, DoesNotMindWhichWayRoundAFaceRuns) {
  SheetScene scene = square();
  scene.initial(1, 4) = 0.2;
  const Problem plain = make_problem(scene);
  std::reverse(scene.faces[1].begin(), scene.faces[1].end());
  const Problem turned = make_problem(scene);
  EXPECT_LT((turned.cloth().relative_mass - plain.cloth().relative_mass).norm(), 1e-15);
  const auto moment = [](const Hinges& hinges) {
    return hinges.stiffness.dot(hinges.rest_angle.cwiseAbs());
  };
  EXPECT_NEAR(turned.sheet().hinges.stiffness.sum(), plain.sheet().hinges.stiffness.sum(), 1e-16);
  EXPECT_NEAR(moment(turned.sheet().hinges), moment(plain.sheet().hinges), 1e-16);
}

// A strip with half a turn has no two sides; it is a cloth for all that.
TEST(SheetScene, MayBeAMoebiusStrip) {
  constexpr Index n = 24;
  SheetScene scene = square();
  scene.reference = Reference::morph;
  scene.initial.resize(3, 2 * n);
  scene.faces.clear();
  for (Index i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    for (const Index side : {0, 1}) {
      const double v = side == 0 ? -0.1 : 0.1, r = 1 + v * std::cos(angle / 2);
      scene.initial.col(2 * i + side) << r * std::cos(angle), v * std::sin(angle / 2),
          r * std::sin(angle);
    }
    const bool last = i + 1 == n;
    scene.faces.push_back({2 * i, 2 * i + 1, last ? 0 : 2 * i + 3, last ? 1 : 2 * i + 2});
  }
  scene.target = scene_library::placed(scene.initial, {1, 0, 0}, {3, 0, 0});
  const Problem problem = make_problem(scene);
  EXPECT_TRUE(problem.sheet().hinges.rest_angle.allFinite());
  SheetMorph morph(problem, 0.5);
  morph.advance();
  EXPECT_TRUE(morph.shape().allFinite());
}

TEST(SheetScene, FitsTheTargetUntilTheAreaAgreesAboutItsMassCenter) {
  SheetScene scene = square();
  scene.faces = {{0, 3, 4}, {0, 4, 1}, {1, 4, 5, 2}, {3, 6, 7, 4}, {4, 7, 8, 5}};
  scene.initial.col(0) << -0.9, 0, -0.6;  // masses that differ
  scene.target = scene_library::placed(2.5 * scene.initial, {0.3, 1, 0}, {3, 1, 2});
  const Problem fit = make_problem(scene);
  const Cloth& cloth = fit.cloth();
  EXPECT_NEAR(area(fit.target, scene.faces), cloth.size * cloth.size, 1e-14);
  EXPECT_NEAR(fit.target_scale, 0.4, 1e-15);
  EXPECT_LT((cloth.mass_center(fit.target) - cloth.mass_center(scene.target)).norm(), 1e-14);
  EXPECT_GT((centroid(fit.target) - centroid(scene.target)).norm(), 1e-3);

  scene.target_length = TargetLength::as_drawn;
  EXPECT_EQ(make_problem(scene).target, scene.target);
}

}  // namespace
}  // namespace nuno
