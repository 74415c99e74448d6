// Wavefront OBJ as programs write it.

#include <nuno/mesh.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>

#include "temporary_folder.h"

namespace nuno {
namespace {

/// A unit square of 4 vertices and 4 texture points, without faces.
const std::string square =
    "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "vn 0 1 0\n";

std::string refusal(const std::string& text) {
  try {
    parse_obj(text, "a.obj");
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Obj, ReadsEveryFormOfAnIndexAlike) {
  const Faces expected = {{0, 1, 2, 3}};
  for (const char* face : {"1 2 3 4", "1// 2// 3// 4//", "1//1 2//1 3//1 4//1", "-4 -3 -2 -1",
                           "-4//-1 -3//-1 -2//-1 -1//-1"}) {
    const Mesh mesh = parse_obj(square + "f " + face + "\n", "a.obj");
    EXPECT_EQ(mesh.faces, expected) << face;
    EXPECT_TRUE(mesh.texture_corners.empty()) << face;
    EXPECT_EQ(mesh.texture_coordinates.cols(), 0) << face;
  }
  for (const char* face : {"1/4 2/3 3/2 4/1", "1/4/1 2/3/1 3/2/1 4/1/1", "-4/-1 -3/-2 -2/-3 -1/-4",
                           "1/4/ 2/3/ 3/2/ 4/1/", "1/-1/-1 -3/3/1 3/-3/-1 -1/1/1"}) {
    const Mesh mesh = parse_obj(square + "f " + face + "\n", "a.obj");
    EXPECT_EQ(mesh.faces, expected) << face;
    EXPECT_EQ(mesh.texture_corners, Faces({{3, 2, 1, 0}})) << face;
    EXPECT_EQ(mesh.texture_coordinates, Points({{0, 1, 1, 0}, {0, 0, 1, 1}})) << face;
  }
}

TEST(Obj, CountsBackFromTheLineThatAFaceStandsOn) {
  const Mesh mesh =
      parse_obj("v 0 0 0\nv 1 0 0\nv 0 0 1\nf -3 -2 -1\nv 1 0 1\nf -1 -2 -3\n# the end\n", "a.obj");
  EXPECT_EQ(mesh.faces, Faces({{0, 1, 2}, {3, 2, 1}}));
  EXPECT_EQ(mesh.lines, std::vector<Index>({4, 6}));
  EXPECT_EQ(mesh.vertex_lines, std::vector<Index>({1, 2, 3, 5}));
}

TEST(Obj, ReadsNumbersToTheirLastBit) {
  const Mesh mesh = parse_obj(
      "v 0.1 -1e-3 +2.5E2\nv .5 5. -0\nv 0.30000000000000004 1e-400 1e12 0.7 0.2 0.1\nf 1 2 3\n",
      "a.obj");
  EXPECT_EQ(mesh.vertices, Points({{0.1, 0.5, 0.1 + 0.2}, {-1e-3, 5, 0}, {2.5e2, -0.0, 1e12}}));
}

TEST(Obj, PassesOverWhatIsNoShape) {
  const std::string plain = square + "f 1 2 3 4\n";
  const std::string dressed =
      "\xEF\xBB\xBF# Blender 3.4.1\nmtllib cloth.mtl\no Flag\n" + square +
      "g left right\nusemtl red\ns 1\n\n  \t\nl 1 2 3\np 4\nvp 0.5 0.5\n\tf  1\t2 3  4 # quad\n"
      "g\ns off\n";
  const Mesh mesh = parse_obj(dressed, "a.obj");
  EXPECT_EQ(mesh.faces, parse_obj(plain, "a.obj").faces);
  EXPECT_EQ(mesh.vertices, parse_obj(plain, "a.obj").vertices);
}

TEST(Obj, TakesSeveralObjectsAndGroupsAsOneMesh) {
  const Mesh mesh = parse_obj(
      "o left\nv 0 0 0\nv 1 0 0\nv 0 0 1\ng a\nf 1 2 3\n"
      "o right\nv 1 0 1\ng b\nf 2 4 3\n",
      "a.obj");
  EXPECT_EQ(mesh.faces, Faces({{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(mesh.vertices.cols(), 4);
}

TEST(Obj, ReadsLinesAsWindowsEndsThemAndThoseThatGoOn) {
  std::string text = square + "f 1 2 3 4";
  const Mesh plain = parse_obj(text, "a.obj");
  std::string windows;
  for (const char c : text) windows += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(parse_obj(windows, "a.obj").faces, plain.faces);
  EXPECT_EQ(parse_obj(windows, "a.obj").vertices, plain.vertices);

  for (const char* end : {"\n", "\r\n"}) {
    const std::string on = std::string("\\") + end;
    const Mesh mesh = parse_obj("v 0 " + on + "0 0" + end + "v 1 0 0" + end + "v 0 0 1" + end +
                                    "f 1 2 " + on + on + "3" + end + "f 3 2 1" + end,
                                "a.obj");
    EXPECT_EQ(mesh.faces, Faces({{0, 1, 2}, {2, 1, 0}}));
    EXPECT_EQ(mesh.lines, std::vector<Index>({5, 8})) << "a statement stands on its first line";
  }
  EXPECT_EQ(parse_obj(square + "f 1 2 3 \\", "a.obj").faces.size(), 1u);
}

/// The sum of the triangles' areas, signed by the polygon's own normal.
double signed_area(const Points& x, const Faces& triangles, const Eigen::Vector3d& normal) {
  double sum = 0;
  for (const auto& t : triangles) {
    const Eigen::Vector3d a = x.col(t[0]), b = x.col(t[1]), c = x.col(t[2]);
    const double area = 0.5 * (b - a).cross(c - a).dot(normal);
    EXPECT_GT(area, 0) << "a triangle that is turned over or has no area";
    sum += area;
  }
  return sum;
}

TEST(Obj, CutsPolygonsByTheirShape) {
  struct Polygon {
    const char* name;
    std::vector<std::array<double, 2>> corners;
    double area;
  };
  for (const Polygon& of : {
           Polygon{"pentagon", {{0, 0}, {2, 0}, {3, 1}, {1, 2}, {-1, 1}}, 5},
           Polygon{"a corner on a side", {{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}}, 4},
           Polygon{"an L", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 3},
           Polygon{"an arrow", {{0, 0}, {4, 2}, {0, 4}, {1, 3}, {1, 1}}, 5},
           Polygon{"a comb",
                   {{0, 0},
                    {5, 0},
                    {5, 3},
                    {4, 3},
                    {4, 1},
                    {3, 1},
                    {3, 3},
                    {2, 3},
                    {2, 1},
                    {1, 1},
                    {1, 3},
                    {0, 3}},
                   11},
       }) {
    for (std::size_t start = 0; start < of.corners.size(); ++start) {
      // Askew in space, and the file may begin at any corner.
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
      const auto n = static_cast<Index>(of.corners.size());
      Mesh mesh;
      mesh.vertices.resize(3, n);
      mesh.faces.emplace_back();
      mesh.texture_corners.emplace_back();
      mesh.lines = {7};
      for (Index i = 0; i < n; ++i) {
        const auto& c = of.corners[static_cast<std::size_t>(i)];
        mesh.vertices.col(i) = turn * Eigen::Vector3d(c[0], c[1], 0);
        mesh.faces[0].push_back((i + static_cast<Index>(start)) % n);
        mesh.texture_corners[0].push_back(100 + mesh.faces[0].back());
      }
      cut_polygons(mesh);
      ASSERT_EQ(mesh.faces.size(), static_cast<std::size_t>(n - 2)) << of.name;
      EXPECT_EQ(mesh.lines, std::vector<Index>(mesh.faces.size(), 7));
      for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_EQ(mesh.texture_corners[f][k], 100 + mesh.faces[f][k]);
        }
      }
      EXPECT_NEAR(signed_area(mesh.vertices, mesh.faces, turn.col(2)), of.area, 1e-12) << of.name;
    }
  }
}

TEST(Obj, CutsPolygonsWhoseCornersAreCountedBack) {
  const std::string arrow = "v 0 0 0\nv 4 2 0\nv 0 4 0\nv 1 3 0\nv 1 1 0\n";
  const auto cut = [&](const char* face) {
    Mesh mesh = parse_obj(arrow + face, "a.obj");
    cut_polygons(mesh);
    return mesh;
  };
  const Mesh forward = cut("f 1 2 3 4 5\n");
  EXPECT_EQ(forward.faces.size(), 3u);
  EXPECT_NEAR(signed_area(forward.vertices, forward.faces, Eigen::Vector3d::UnitZ()), 5, 1e-12);
  EXPECT_EQ(cut("f -5 -4 -3 -2 -1\n").faces, forward.faces);
}

TEST(Obj, LeavesTrianglesAndQuadsWhole) {
  Mesh mesh = parse_obj(square + "f 1/1 2/2 3/3\nf 1/1 2/2 3/3 4/4\n", "a.obj");
  const Faces faces = mesh.faces, texture = mesh.texture_corners;
  cut_polygons(mesh);
  EXPECT_EQ(mesh.faces, faces);
  EXPECT_EQ(mesh.texture_corners, texture);
}

TEST(Obj, HasNoTextureWhereAFaceHasNone) {
  const Mesh mesh = parse_obj(square + "f 1/1 2/2 3/3\nf 1 3 4\n", "a.obj");
  EXPECT_TRUE(mesh.texture_corners.empty());
  EXPECT_EQ(mesh.texture_coordinates.cols(), 0);
}

TEST(Obj, IsReadFromAFile) {
  const TemporaryFolder folder;
  for (const char* name : {"a.obj", "B.OBJ"}) {
    const std::string path = (folder / name).string();
    std::ofstream(path) << square << "f 1 2 3 4\n";
    EXPECT_EQ(read_mesh(path).faces.size(), 1u);
  }
}

struct BadText {
  const char* text;  ///< after the square
  const char* message;
};

class MalformedObj : public testing::TestWithParam<BadText> {};

TEST_P(MalformedObj, IsRefusedWithFileLineValueAndRule) {
  EXPECT_EQ(refusal(square + GetParam().text), std::string("a.obj:") + GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Lines, MalformedObj,
    testing::Values(
        BadText{"", " has no face (f); a mesh is required"},
        BadText{"l 1 2 3\n", " has no face (f); a mesh is required"},
        BadText{"f 0 1 2\n", "10: 0 names a vertex that is not among the 4 above"},
        BadText{"f 1 2 5\n", "10: 5 names a vertex that is not among the 4 above"},
        BadText{"f 1 2 -5\n", "10: -5 names a vertex that is not among the 4 above"},
        BadText{"f 1/1 2/2 3/5\n", "10: 3/5 names a texture point that is not among the 4 above"},
        BadText{"f 1/1 2/2 3/0\n", "10: 3/0 names a texture point that is not among the 4 above"},
        BadText{"f 1 2 99999999999999999999\n",
                "10: 99999999999999999999 is not a corner: v, v/vt, v//vn or v/vt/vn"},
        BadText{"f 1 2 three\n", "10: three is not a corner: v, v/vt, v//vn or v/vt/vn"},
        BadText{"f 1 2 3.5\n", "10: 3.5 is not a corner: v, v/vt, v//vn or v/vt/vn"},
        BadText{"f 1 2 /3\n", "10: /3 is not a corner: v, v/vt, v//vn or v/vt/vn"},
        BadText{"f 1 2 3/1/1/1\n", "10: 3/1/1/1 is not a corner: v, v/vt, v//vn or v/vt/vn"},
        BadText{"f 1 2\n", "10: 1 2 has fewer than 3 corners"},
        BadText{"f\n", "10: f has fewer than 3 corners"},
        BadText{"f 1 2 3 2\n", "10: 1 2 3 2 has vertex 2 twice"},
        BadText{"f 1 2 3 4 -4\n", "10: 1 2 3 4 -4 has vertex 1 twice"},
        BadText{"v 1 2\n", "10: 1 2 has not 3 numbers"}, BadText{"v\n", "10: v has not 3 numbers"},
        BadText{"vt 1\n", "10: 1 has not 2 numbers"}, BadText{"v 1 2 x\n", "10: x is not a number"},
        BadText{"v 1 2 1,5\n", "10: 1,5 is not a number"},
        BadText{"v 1 2 0x10\n", "10: 0x10 is not a number"},
        BadText{"v 1 2 +-3\n", "10: +-3 is not a number"},
        BadText{"v 1 2 nan\n", "10: nan is not a number"},
        BadText{"v 1 2 -inf\n", "10: -inf is not within ±1000000000000"},
        BadText{"v 1 2 1e400\n", "10: 1e400 is not within ±1000000000000"},
        BadText{"v 1 -2e12 1\n", "10: -2e12 is not within ±1000000000000"},
        BadText{"solid cube\n", "10: solid is not a statement of a Wavefront OBJ file"},
        BadText{"\n\\\nf 1 2 \\\n9\n", "11: 9 names a vertex that is not among the 4 above"}));

}  // namespace
}  // namespace nuno
