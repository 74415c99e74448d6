// What a .glb holds, read back from its bytes.

#include <nuno/glb_file.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "glb_file.h"

namespace nuno {
namespace {

GlbFile written(const std::string& name, const Mesh& mesh, const std::vector<double>& times,
                const std::vector<Points>& positions) {
  std::FILE* const file = std::tmpfile();
  write_glb(file, name, mesh, times, positions);
  std::string bytes(static_cast<std::size_t>(std::ftell(file)), '\0');
  std::rewind(file);
  EXPECT_EQ(std::fread(bytes.data(), 1, bytes.size(), file), bytes.size());
  std::fclose(file);
  return GlbFile(bytes);
}

/// A tent of four triangles about vertex 4, whose texture has a seam: vertex 3 is at its left and
/// at its right.
Mesh tent() {
  return parse_obj(
      "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 0.5 0.3 0.5\n"
      "vt 0 0\nvt 0.25 0\nvt 0.5 0\nvt 0.75 0\nvt 1 0\nvt 0.5 1\n"
      "f 1/2/ 5/6/ 2/3/\nf 2/3 5/6 3/4\nf 3/4 5/6 4/5\nf 4/1 5/6 1/2\n",
      "tent.obj");
}

/// Frames of the tent, turned and carried far away, where floats are coarse.
std::vector<Points> flight(const Points& start, const std::vector<double>& times) {
  std::vector<Points> frames;
  for (const double t : times) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(2 * t, Eigen::Vector3d(1, 0.3, -0.2).normalized()).toRotationMatrix();
    frames.emplace_back((turn * start).colwise() + Eigen::Vector3d(1000.1 + t, -200 * t, 3));
  }
  return frames;
}

const std::vector<double> times = {0, 1.0 / 24, 2.0 / 24, 3.0 / 24, 0.15};

/// Which vertex of the mesh each vertex of the file is, by the corners of its triangles.
std::vector<Index> sources(const GlbFile& file, const Mesh& mesh) {
  const Points indices = file.indices();
  std::vector<Index> result(file.at_frame("POSITION", 0).cols(), -1);
  for (Index i = 0; i < indices.cols(); ++i) {
    const auto& face = mesh.faces[static_cast<std::size_t>(i / 3)];
    Index& source = result[static_cast<std::size_t>(indices(0, i))];
    EXPECT_TRUE(source < 0 || source == face[static_cast<std::size_t>(i % 3)]);
    source = face[static_cast<std::size_t>(i % 3)];
  }
  return result;
}

TEST(Glb, KeepsTheNumbersOfTheVertices) {
  const Mesh textured = tent();
  Mesh plain = textured;
  plain.texture_corners.clear();
  EXPECT_EQ(sources(written("tent", textured, {0}, {textured.vertices}), textured),
            std::vector<Index>({0, 1, 2, 3, 4, 3}));
  EXPECT_EQ(sources(written("tent", plain, {0}, {plain.vertices}), plain),
            std::vector<Index>({0, 1, 2, 3, 4}));
}

TEST(Glb, HoldsEveryFrameToTheRoundingOfFloats) {
  const Mesh mesh = tent();
  const std::vector<Points> frames = flight(mesh.vertices, times);
  const GlbFile file = written("tent", mesh, times, frames);
  ASSERT_EQ(file.frames(), frames.size());
  const std::vector<Index> source = sources(file, mesh);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Points expected = frames[k](Eigen::all, source), found = file.at_frame("POSITION", k);
    // The first is rounded at 1000 m; what others are moved by carries what that lost.
    const Points moved = k == 0 ? expected : expected - file.at_frame("POSITION", 0);
    for (Index i = 0; i < found.size(); ++i) {
      EXPECT_LE(std::abs(found.data()[i] - expected.data()[i]),
                std::ldexp(std::abs(moved.data()[i]), -24))
          << "frame " << k;
    }
  }
}

TEST(Glb, PlaysEveryFrameAtItsTimeAndEndsAtTheLast) {
  const Mesh mesh = tent();
  const GlbFile file = written("tent", mesh, times, flight(mesh.vertices, times));
  const Points keys = file.sampler("input"), weights = file.sampler("output");
  const auto frames = static_cast<Index>(times.size());
  ASSERT_EQ(keys.cols(), frames);
  for (Index k = 0; k < frames; ++k) {
    EXPECT_EQ(keys(0, k), static_cast<float>(times[static_cast<std::size_t>(k)]));
  }
  ASSERT_EQ(weights.cols(), frames * (frames - 1));
  for (Index k = 0; k < frames; ++k) {
    for (Index target = 1; target < frames; ++target) {
      EXPECT_EQ(weights(0, k * (frames - 1) + target - 1), k == target ? 1 : 0);
    }
  }
  const auto& channel = file.json["animations"][0]["channels"][0];
  EXPECT_EQ(channel["target"]["path"], "weights");
  EXPECT_EQ(file.json["nodes"][channel["target"]["node"].get<std::size_t>()]["mesh"], 0);
  EXPECT_EQ(file.json["meshes"][0]["extras"]["targetNames"].size(), times.size() - 1);
}

TEST(Glb, HasUnitNormalsThatTurnWithTheCloth) {
  const Mesh mesh = tent();
  const std::vector<Points> frames = flight(mesh.vertices, times);
  const GlbFile file = written("tent", mesh, times, frames);
  const std::vector<Index> source = sources(file, mesh);
  const Points first = file.at_frame("NORMAL", 0);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Points found = file.at_frame("NORMAL", k);
    EXPECT_LT((found.colwise().norm().array() - 1).abs().maxCoeff(), 1e-6);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(2 * times[k], Eigen::Vector3d(1, 0.3, -0.2).normalized())
            .toRotationMatrix();
    EXPECT_LT((found - turn * first).cwiseAbs().maxCoeff(), 1e-6) << "frame " << k;
  }
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (source[i] != 4) continue;  // the tip, by symmetry
    EXPECT_LT((first.col(static_cast<Index>(i)) - Points(Eigen::Vector3d(0, 1, 0))).norm(), 1e-6);
  }
}

TEST(Glb, SplitsAVertexWhereTheTextureHasASeam) {
  const Mesh mesh = tent();
  const GlbFile file = written("tent", mesh, times, flight(mesh.vertices, times));
  EXPECT_EQ(file.at_frame("POSITION", 0).cols(), 6) << "of 5, one of which has two texture points";
  const Points texture = file.at_frame("TEXCOORD_0", 0), indices = file.indices();
  ASSERT_EQ(texture.cols(), 6);
  ASSERT_EQ(indices.cols(), 12);
  for (Index i = 0; i < indices.cols(); ++i) {
    const Index corner =
        mesh.texture_corners[static_cast<std::size_t>(i / 3)][static_cast<std::size_t>(i % 3)];
    const auto found = texture.col(static_cast<Index>(indices(0, i)));
    EXPECT_EQ(found[0], static_cast<float>(mesh.texture_coordinates(0, corner)));
    EXPECT_EQ(found[1], 1 - static_cast<float>(mesh.texture_coordinates(1, corner)));
  }
  const std::vector<Index> source = sources(file, mesh);
  const Points last = file.at_frame("POSITION", times.size() - 1);
  std::vector<Index> twins;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (source[i] == 3) twins.push_back(static_cast<Index>(i));
  }
  ASSERT_EQ(twins.size(), 2u);
  EXPECT_EQ(last.col(twins[0]), last.col(twins[1])) << "the seam must not open";
}

TEST(Glb, CutsFacesIntoTriangles) {
  const Mesh mesh = parse_obj(
      "v 0 0 0\nv 2 0 0\nv 2 0 1\nv 1 0 1\nv 1 0 2\nv 0 0 2\nf 1 2 3 4\nf 1 4 5 6\n", "l.obj");
  const GlbFile file = written("l", mesh, {0}, {mesh.vertices});
  const Points x = file.at_frame("POSITION", 0), indices = file.indices();
  ASSERT_EQ(indices.cols(), 12);
  double area = 0;
  for (Index i = 0; i < 12; i += 3) {
    const auto corner = [&](Index k) -> Eigen::Vector3d {
      return x.col(static_cast<Index>(indices(0, i + k)));
    };
    area += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  }
  EXPECT_NEAR(area, 3, 1e-6);
  EXPECT_FALSE(file.primitive()["attributes"].contains("TEXCOORD_0"));
}

TEST(Glb, OfOneFrameDoesNotMove) {
  const Mesh mesh = tent();
  const GlbFile file = written("still", mesh, {0}, {mesh.vertices});
  EXPECT_FALSE(file.json.contains("animations"));
  EXPECT_FALSE(file.primitive().contains("targets"));
}

TEST(Glb, HasTheSceneAsItsNameWhateverItIs) {
  for (const std::string name : {"flag", "a \"b\"\n\\", "布"}) {
    const GlbFile file = written(name, tent(), {0}, {tent().vertices});
    EXPECT_EQ(file.json["nodes"][0]["name"], name);
    EXPECT_EQ(file.json["meshes"][0]["name"], name);
  }
  EXPECT_NE(written("\xff", tent(), {0}, {tent().vertices}).json["nodes"][0]["name"], "")
      << "no UTF-8 in, UTF-8 out";
}

}  // namespace
}  // namespace nuno
