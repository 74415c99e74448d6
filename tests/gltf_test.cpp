// Meshes from glTF files.

#include <gtest/gtest.h>

#include <nuno/glb_file.h>
#include <nuno/mesh.h>
#include <nuno/output.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "gltf_builder.h"
#include "temporary_folder.h"

namespace nuno {
namespace {

using Json = nlohmann::json;

class GltfMesh : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string path = folder_ / name;
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  Mesh read(const Gltf& gltf, const std::string& target = "") const {
    return read_mesh(write("cloth.gltf", gltf.text()) + target);
  }
  std::string in_folder(const std::string& name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
};

Points columns(std::initializer_list<double> numbers) {
  return Eigen::Map<const Points>(numbers.begin(), 3, std::ssize(numbers) / 3);
}

const Points square = columns({0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 1});

TEST_F(GltfMesh, ComesBackFromOurOwnFileToTheBitsOfFloats) {
  Mesh mesh;
  mesh.vertices.resize(3, 6);
  mesh.vertices << 0.1, 1.3, 2.7, 0.1, 1.3, 2.7,  //
      0, 0.2, 0, 0.1, 0.4, 0.3,                   //
      0, 0, 0, 1, 1, 1;
  mesh.faces = {{0, 3, 4, 1}, {1, 4, 5, 2}};
  mesh.texture_coordinates.resize(2, 8);  // the second square has a place of its own
  mesh.texture_coordinates << 0, 0.25, 0.25, 0, 0.5, 0.75, 0.75, 0.5,  //
      0, 0, 1, 1, 0.5, 0.5, 1, 1;
  mesh.texture_corners = {{0, 3, 2, 1}, {4, 7, 6, 5}};
  Points end = mesh.vertices;
  end.row(1).array() += 0.7;
  const std::string path = in_folder("flight.glb");
  {
    const File file(std::fopen(path.c_str(), "wb"));
    write_glb(file.get(), "cloth", mesh, {0, 1}, {mesh.vertices, end});
  }
  Mesh start = read_mesh(path), target = read_mesh(path + "#");
  EXPECT_EQ(start.vertices.cols(), 8) << "two vertices are on the seam";
  weld_seams(start, target);
  require_same_faces(start, "start", target, "target");
  ASSERT_EQ(start.vertices.cols(), 6);
  ASSERT_EQ(start.faces.size(), 4u);
  for (std::size_t f = 0; f < 4; ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      // Each corner is one of the quad's, in shape, target and texture.
      const auto& quad = mesh.faces[f / 2];
      const Eigen::Vector3d at = start.vertices.col(start.faces[f][k]);
      std::size_t c = 0;
      while (c < 4 && mesh.vertices.col(quad[c]).cast<float>() != at.cast<float>()) ++c;
      ASSERT_LT(c, 4u);
      EXPECT_EQ(at, mesh.vertices.col(quad[c]).cast<float>().cast<double>());
      EXPECT_NEAR(target.vertices(1, start.faces[f][k]), end(1, quad[c]), 1e-7)
          << "a float's moves";
      EXPECT_EQ(start.texture_coordinates.col(start.texture_corners[f][k]),
                mesh.texture_coordinates.col(mesh.texture_corners[f / 2][c]));
    }
  }
}

TEST_F(GltfMesh, IsTheSameFromTextBinaryAndAFileBesideIt) {
  const Gltf gltf = square_gltf();
  Gltf apart = gltf;
  apart.json["buffers"] = {{{"byteLength", apart.buffer.size()}, {"uri", "a%20b.bin"}}};
  write("a b.bin", apart.buffer + "more");
  write("apart.gltf", apart.text());
  write("cloth.glb", gltf.binary());
  write("text.gltf", gltf.text());
  for (const char* name : {"apart.gltf", "cloth.glb", "text.gltf"}) {
    const Mesh mesh = read_mesh(in_folder(name));
    EXPECT_EQ(mesh.vertices, square) << name;
    EXPECT_EQ(mesh.faces, (Faces{{0, 2, 1}, {1, 2, 3}})) << name;
    EXPECT_TRUE(mesh.remarks.empty());
  }
}

TEST_F(GltfMesh, HasItsMorphTargetOnTopByNameNumberOrAlone) {
  Gltf gltf = square_gltf();
  const Points up = square.colwise() + Eigen::Vector3d::UnitY();
  EXPECT_EQ(read(gltf, "#up").vertices, up);
  EXPECT_EQ(read(gltf, "#").vertices, up);
  EXPECT_EQ(read(gltf).vertices, square);
  gltf.json["meshes"][0]["weights"] = {1};
  EXPECT_EQ(read(gltf).vertices, square) << "the start is the base, wherever the slider was";
  gltf.primitive()["targets"].push_back(Json::object());  // moves no position
  gltf.json["meshes"][0].erase("extras");
  EXPECT_EQ(read(gltf, "#0").vertices, up);
  EXPECT_EQ(read(gltf, "#1").vertices, square);
  EXPECT_THROW(read(gltf, "#"), InputError);
  EXPECT_THROW(read(gltf, "#2"), InputError);
}

TEST_F(GltfMesh, TakesPositionsOfEveryTypeNormalisedOrNot) {
  const auto check = [&](auto zero, int component_type, double largest) {
    using Number = decltype(zero);
    Gltf gltf = square_gltf();
    gltf.primitive().erase("targets");
    std::vector<Number> numbers;
    for (int i = 0; i < 12; ++i) {
      numbers.push_back(static_cast<Number>(std::is_signed_v<Number> ? 10 * (6 - i) : 20 * i));
    }
    if (largest > 0) numbers[11] = std::numeric_limits<Number>::min();  // below −1 if it is signed
    const std::size_t position = gltf.add(numbers, component_type, "VEC3");
    gltf.primitive()["attributes"]["POSITION"] = position;
    const Mesh plain = read(gltf);
    gltf.json["accessors"][position]["normalized"] = true;
    const Mesh normalised = read(gltf);
    for (Index i = 0; i < 12; ++i) {
      const auto value = static_cast<double>(numbers[static_cast<std::size_t>(i)]);
      EXPECT_EQ(plain.vertices(i), value) << component_type;
      EXPECT_EQ(normalised.vertices(i), largest > 0 ? std::max(value / largest, -1.0) : value)
          << component_type;
    }
  };
  check(std::int8_t{}, 5120, 127);
  check(std::uint8_t{}, 5121, 255);
  check(std::int16_t{}, 5122, 32767);
  check(std::uint16_t{}, 5123, 65535);
  check(float{}, 5126, 0);
}

TEST_F(GltfMesh, TakesAMorphTargetOfNormalisedNumbers) {
  Gltf gltf = square_gltf();
  const std::size_t moves = gltf.add(
      std::vector<std::int8_t>{0, 127, 0, 0, 127, 0, -127, 127, 0, 0, 127, -128}, 5120, "VEC3");
  gltf.json["accessors"][moves]["normalized"] = true;
  gltf.primitive()["targets"][0]["POSITION"] = moves;
  Points moved = square.colwise() + Eigen::Vector3d::UnitY();
  moved(0, 2) -= 1;
  moved(2, 3) -= 1;
  EXPECT_EQ(read(gltf, "#up").vertices, moved);
}

TEST_F(GltfMesh, TakesIndicesOfEveryTypeOrNone) {
  const auto check = [&](auto zero, int component_type) {
    using Number = decltype(zero);
    Gltf gltf = square_gltf();
    gltf.primitive()["indices"] = gltf.add<Number>({3, 2, 1}, component_type, "SCALAR");
    EXPECT_EQ(read(gltf).faces, (Faces{{3, 2, 1}})) << component_type;
  };
  check(std::uint8_t{}, 5121);
  check(std::uint16_t{}, 5123);
  check(std::uint32_t{}, 5125);
  Gltf gltf = square_gltf();
  gltf.primitive().erase("indices");
  gltf.primitive().erase("targets");
  gltf.primitive()["attributes"]["POSITION"] =
      gltf.add_floats({0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1});
  EXPECT_EQ(read(gltf).faces, (Faces{{0, 1, 2}, {3, 4, 5}}));
}

TEST_F(GltfMesh, TakesStripsAndFansAndPassesOverLinesAndPoints) {
  Gltf gltf = square_gltf();
  gltf.primitive()["mode"] = 5;
  gltf.primitive()["indices"] = gltf.add<std::uint8_t>({0, 1, 2, 3, 3, 0, 0, 1}, 5121, "SCALAR");
  EXPECT_EQ(read(gltf).faces, (Faces{{0, 1, 2}, {1, 3, 2}}))
      << "those that only lead on have no area";
  gltf.primitive()["mode"] = 6;
  gltf.primitive()["indices"] = gltf.add<std::uint8_t>({0, 1, 3, 2}, 5121, "SCALAR");
  EXPECT_EQ(read(gltf).faces, (Faces{{1, 3, 0}, {3, 2, 0}}));
  Json lines = gltf.primitive();
  lines["mode"] = 1;
  gltf.json["meshes"][0]["primitives"].push_back(lines);
  EXPECT_EQ(read(gltf).faces.size(), 2u);
  gltf.primitive()["mode"] = 0;
  EXPECT_THROW(read(gltf), InputError) << "no triangle is left";
}

TEST_F(GltfMesh, TakesInterleavedElements) {
  Gltf gltf;
  std::string bytes = "offset..";
  for (const int i : {0, 1, 2, 3}) {
    const auto x = static_cast<float>(i % 2), z = static_cast<float>(i / 2);
    bytes += bytes_of<float>({x, 0, z}) +
             bytes_of<std::uint16_t>({static_cast<std::uint16_t>(13107 * i), 65535});
  }
  const std::size_t view = gltf.view(bytes);
  gltf.json["bufferViews"][view]["byteStride"] = 16;
  gltf.primitive()["attributes"]["POSITION"] = gltf.accessor({{"bufferView", view},
                                                              {"byteOffset", 8},
                                                              {"componentType", 5126},
                                                              {"type", "VEC3"},
                                                              {"count", 4}});
  gltf.primitive()["attributes"]["TEXCOORD_0"] = gltf.accessor({{"bufferView", view},
                                                                {"byteOffset", 20},
                                                                {"componentType", 5123},
                                                                {"normalized", true},
                                                                {"type", "VEC2"},
                                                                {"count", 4}});
  gltf.primitive()["indices"] = gltf.add<std::uint16_t>({0, 2, 1, 1, 2, 3}, 5123, "SCALAR");
  const Mesh mesh = read(gltf);
  EXPECT_EQ(mesh.vertices, square);
  for (Index i = 0; i < 4; ++i) {
    EXPECT_EQ(mesh.texture_coordinates(0, i), 13107 * static_cast<double>(i) / 65535);
    EXPECT_EQ(mesh.texture_coordinates(1, i), 0) << "counted from below";
  }
  EXPECT_EQ(mesh.texture_corners, mesh.faces);
}

TEST_F(GltfMesh, TakesSparseElementsOnAViewOrOnNothing) {
  Gltf gltf = square_gltf();
  const Json sparse = {
      {"count", 2},
      {"indices",
       {{"bufferView", gltf.view(bytes_of<std::uint8_t>({9, 1, 3}))},
        {"byteOffset", 1},
        {"componentType", 5121}}},
      {"values", {{"bufferView", gltf.view(bytes_of<float>({4, 5, 6, 7, 8, 9}))}}}};
  const std::size_t on_nothing =
      gltf.accessor({{"componentType", 5126}, {"type", "VEC3"}, {"count", 4}, {"sparse", sparse}});
  gltf.primitive()["targets"][0]["POSITION"] = on_nothing;
  Points moved = square;
  moved.col(1) += Eigen::Vector3d(4, 5, 6);
  moved.col(3) += Eigen::Vector3d(7, 8, 9);
  EXPECT_EQ(read(gltf, "#up").vertices, moved);
  gltf.primitive().erase("targets");
  gltf.json["accessors"][gltf.primitive()["attributes"]["POSITION"].get<std::size_t>()]["sparse"] =
      sparse;
  Points put = square;
  put.col(1) = Eigen::Vector3d(4, 5, 6);
  put.col(3) = Eigen::Vector3d(7, 8, 9);
  EXPECT_EQ(read(gltf).vertices, put);
}

TEST_F(GltfMesh, StandsWhereItsNodeAndThoseAboveItSay) {
  Gltf gltf = square_gltf();
  const double half = std::numbers::sqrt2 / 2;
  gltf.json["nodes"] = {
      {{"mesh", 0},
       {"translation", {1, 2, 3}},
       {"rotation", {0, half, 0, half}},
       {"scale", {2, 3, 4}}},
      {{"name", "another"}},
      {{"children", {1, 0}}, {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}}}};
  // Scaled, turned about y by 90° (x to −z, z to x), moved; then about z by 90° (x to y), moved.
  for (const std::string target : {"", "#up"}) {
    const Mesh mesh = read(gltf, target);
    const double y = target.empty() ? 0 : 1;
    for (Index i = 0; i < 4; ++i) {
      const double x = square(0, i), z = square(2, i);
      const Eigen::Vector3d in_parent(1 + 4 * z, 2 + 3 * y, 3 - 2 * x);
      const Eigen::Vector3d expected(10 - in_parent.y(), 20 + in_parent.x(), 30 + in_parent.z());
      EXPECT_LT((mesh.vertices.col(i) - expected).norm(), 1e-14) << i;
    }
    EXPECT_EQ(mesh.faces[0], (std::vector<Index>{0, 2, 1}));
  }
}

TEST_F(GltfMesh, TellsItsMorphTargetsInWholeCharacters) {
  for (const char* start : {"", "a"}) {  // a cut between two bytes of a character in one of them
    Gltf gltf = square_gltf();
    std::string name = start;
    while (name.size() < 300) name += "é";
    gltf.json["meshes"][0]["extras"]["targetNames"] = {name};
    try {
      (void)read(gltf, "#down");
      FAIL() << "has no such morph target";
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message, printable(message));
      EXPECT_EQ(message.find("\xef\xbf\xbd"), std::string::npos) << message;
      EXPECT_TRUE(message.ends_with("éé...")) << message;
    }
  }
}

TEST_F(GltfMesh, MirroredByItsNodeKeepsItsFrontInFront) {
  Gltf gltf = square_gltf();
  gltf.json["nodes"][0]["scale"] = {-1, 1, 1};
  const Mesh mesh = read(gltf);
  ASSERT_EQ(mesh.vertices.col(1), Eigen::Vector3d(-1, 0, 0));
  const Eigen::Vector3d a = mesh.vertices.col(mesh.faces[0][0]),
                        b = mesh.vertices.col(mesh.faces[0][1]),
                        c = mesh.vertices.col(mesh.faces[0][2]);
  EXPECT_GT((b - a).cross(c - a).y(), 0) << "as before the mirror";
  gltf.json["nodes"][0]["scale"] = {-1, -1, 1};
  EXPECT_EQ(read(gltf).faces[0], (std::vector<Index>{0, 2, 1})) << "a turn is no mirror";
}

TEST_F(GltfMesh, JoinsItsPrimitivesAndTheirSeam) {
  Gltf gltf = square_gltf();
  Json second = gltf.primitive();
  second["attributes"]["POSITION"] = gltf.add_floats({1, 0, 0, 2, 0, 0, 1, 0, 1, 2, 0, 1});
  second["material"] = 1;
  gltf.json["meshes"][0]["primitives"].push_back(second);
  Mesh start = read(gltf), target = read(gltf, "#up");
  EXPECT_EQ(start.vertices.cols(), 8);
  EXPECT_EQ(start.faces[2], (std::vector<Index>{4, 6, 5}));
  weld_seams(start, target);
  EXPECT_EQ(start.vertices.cols(), 6);
  EXPECT_EQ(start.file_vertices, (std::vector<Index>{0, 1, 2, 3, 1, 4, 3, 5}));
  EXPECT_EQ(target.vertices, start.vertices.colwise() + Eigen::Vector3d::UnitY());
}

TEST_F(GltfMesh, SharesTheVerticesThatItsPrimitivesShare) {
  Gltf gltf = square_gltf();
  Json second = gltf.primitive();
  gltf.primitive()["indices"] = gltf.add<std::uint8_t>({0, 2, 1}, 5121, "SCALAR");
  second["indices"] = gltf.add<std::uint8_t>({1, 2, 3}, 5121, "SCALAR");
  gltf.json["meshes"][0]["primitives"].push_back(second);
  const Mesh mesh = read(gltf);
  EXPECT_EQ(mesh.vertices, square);
  EXPECT_EQ(mesh.faces, (Faces{{0, 2, 1}, {1, 2, 3}}));
}

TEST_F(GltfMesh, ThatIsNotTheOnlyOneIsTheFirstAndSaysSo) {
  Gltf gltf = square_gltf();
  gltf.json["meshes"].push_back(gltf.json["meshes"][0]);
  gltf.json["nodes"] = {{{"mesh", 1}, {"translation", {9, 9, 9}}},
                        {{"mesh", 0}, {"translation", {1, 0, 0}}}};
  const Mesh mesh = read(gltf);
  EXPECT_EQ(mesh.vertices, square.colwise() + Eigen::Vector3d::UnitX());
  ASSERT_EQ(mesh.remarks.size(), 1u);
  EXPECT_NE(mesh.remarks[0].find("the first of the 2 meshes"), std::string::npos);
}

}  // namespace
}  // namespace nuno
