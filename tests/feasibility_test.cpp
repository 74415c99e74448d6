#include <nuno/feasibility.h>
#include <nuno/native.h>

#include <gtest/gtest.h>

#include <numbers>

#include "sheet_library.h"

namespace nuno {
namespace {

Feasibility of(const scene_library::FlatMesh& mesh, const Points& target) {
  SheetScene scene;
  scene.arrival_time = 1;
  scene.initial = mesh.vertices;
  scene.faces = mesh.faces;
  scene.target = target;
  scene.target_length = TargetLength::as_drawn;
  scene.reference = Reference::morph;
  return assess(*native::make_backend(make_problem(scene)));
}

/// Turned by `angle` about the line x = 0.
Points folded(const Points& flat, double angle) {
  Points x = flat;
  for (Index i = 0; i < x.cols(); ++i) {
    const double u = x(0, i);
    if (u > 0) x.col(i).head(2) << u * std::cos(angle), u * std::sin(angle);
  }
  return x;
}

TEST(Feasibility, SaysNothingOfATargetThatTheSheetCanTake) {
  const auto mesh = scene_library::grid(1, 1, 17, 17);
  const Points pipe = scene_library::bent(mesh.vertices, 0, [](double u) { return 3 * u; });
  const Feasibility result = of(mesh, pipe);
  EXPECT_NEAR(result.folding, 3.0 / 16, 1e-3);
  EXPECT_EQ(verdict(result), "");
}

// Edges along x of a sheet that is drawn out there, as far as each row goes.
TEST(Feasibility, TellsWhereTheTargetIsTooLongAndTooShort) {
  const auto mesh = scene_library::grid(1, 1, 5, 5);
  Points wide_at_the_border = mesh.vertices, wide_inside = mesh.vertices;
  for (Index i = 0; i < mesh.vertices.cols(); ++i) {
    const double z = mesh.vertices(2, i);
    wide_at_the_border(0, i) *= 1 + 0.8 * z * z;
    wide_inside(0, i) *= 1 + 0.1 * (1 - 4 * z * z);
  }
  const Feasibility border = of(mesh, wide_at_the_border), inside = of(mesh, wide_inside);
  EXPECT_NEAR(border.border.too_long, 0.2, 1e-12);
  EXPECT_NEAR(border.inside.too_long, 0.05, 0.01);
  EXPECT_NEAR(inside.inside.too_long, 0.1, 1e-12);
  EXPECT_EQ(verdict(border).substr(0, verdict(border).find('\n')),
            "The target is 20.0 % too long along its border: the cloth comes near, not onto it.");
  EXPECT_EQ(verdict(inside).substr(0, verdict(inside).find('\n')),
            "The target is 10.0 % too long inside: the cloth comes near, not onto it.");

  Points both = mesh.vertices;
  both.row(0) *= 1.03;
  both.row(2) *= 0.96;
  const std::string words = verdict(of(mesh, both));
  EXPECT_EQ(words.substr(0, words.find(':')), "The target is 3.0 % too long and 4.0 % too short");
}

TEST(Feasibility, WarnsOfAFoldThatIsTooSharpForTheMesh) {
  const auto mesh = scene_library::in_triangles(scene_library::grid(1, 1, 5, 5));
  const Feasibility sharp = of(mesh, folded(mesh.vertices, 2.5));
  EXPECT_NEAR(sharp.folding, 2.5, 1e-12);
  EXPECT_NE(verdict(sharp).find("folds by 143° at an edge"), std::string::npos) << verdict(sharp);
  EXPECT_EQ(verdict(of(mesh, folded(mesh.vertices, 1.5))).find("folds"), std::string::npos);
}

}  // namespace
}  // namespace nuno
