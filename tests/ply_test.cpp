// Meshes from PLY files.

#include <gtest/gtest.h>

#include <nuno/mesh.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace nuno {
namespace {

const std::string square = R"(ply
format ascii 1.0
comment a square of two quads
element vertex 6
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
0 0 0
0.5 0.25 0
1 0 0
0 0 1
0.5 0 1
1 0 1
4 0 3 4 1
4 1 4 5 2
)";

std::string replaced(std::string text, const std::string& old, const std::string& fresh) {
  return text.replace(text.find(old), old.size(), fresh);
}

Mesh parse(const std::string& text) { return parse_ply(text, "cloth.ply"); }

/// Bytes of a number as a file of that order has them.
template <typename Number>
std::string stored(Number number, std::endian order) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return order == std::endian::native ? bytes : std::string(bytes.rbegin(), bytes.rend());
}

TEST(Ply, GivesVerticesFacesAndTheLinesOfFaces) {
  const Mesh mesh = parse(square);
  Points expected(3, 6);
  expected << 0, 0.5, 1, 0, 0.5, 1,  //
      0, 0.25, 0, 0, 0, 0,           //
      0, 0, 0, 1, 1, 1;
  EXPECT_EQ(mesh.vertices, expected);
  EXPECT_EQ(mesh.faces, (Faces{{0, 3, 4, 1}, {1, 4, 5, 2}}));
  EXPECT_EQ(mesh.lines, (std::vector<Index>{17, 18}));
  EXPECT_TRUE(mesh.texture_corners.empty());
  EXPECT_FALSE(mesh.splits_seams) << "nothing for which a vertex would be split";
}

TEST(Ply, OfWindowsIsTheSame) {
  std::string text;
  for (const char c : square) text += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(parse(text).vertices, parse(square).vertices);
}

/// Elements and properties that do not count stand between those that do; so do numbers of every
/// type, of which integers must keep their sign.
std::string mixed(std::endian order) {
  const auto put = [order](auto number) { return stored(number, order); };
  std::string text = order == std::endian::little ? "ply\nformat binary_little_endian 1.0\n"
                                                  : "ply\nformat binary_big_endian 1.0\n";
  text +=
      "element material 2\nproperty uchar red\nproperty list ushort double curve\n"
      "element face 2\nproperty short group\nproperty list uint32 uint16 vertex_index\n"
      "property list int8 float32 texcoord\n"
      "element nothing 4000000000\n"
      "element vertex 5\nproperty float64 z\nproperty char quality\nproperty short x\n"
      "property list uchar uchar tags\nproperty float y\nproperty float texture_v\n"
      "property float texture_u\nend_header\n";
  for (const int curve : {0, 3}) {
    text += put(std::uint8_t{10}) + put(static_cast<std::uint16_t>(curve));
    for (int k = 0; k < curve; ++k) text += put(0.5);
  }
  for (const std::vector<std::uint16_t>& face :
       {std::vector<std::uint16_t>{0, 1, 2}, {0, 2, 3, 4}}) {
    text += put(std::int16_t{-7}) + put(static_cast<std::uint32_t>(face.size()));
    for (const std::uint16_t corner : face) text += put(corner);
    text += put(std::int8_t{2}) + put(1.0F) + put(2.0F);
  }
  for (int i = 0; i < 5; ++i) {
    text += put(1e-3 * i) + put(std::int8_t{-1}) + put(static_cast<std::int16_t>(-300 * i)) +
            put(std::uint8_t{2}) + put(std::uint8_t{9}) + put(std::uint8_t{9}) +
            put(0.1F * static_cast<float>(i * i)) + put(0.25F) +
            put(0.125F * static_cast<float>(i));
  }
  return text;
}

TEST(Ply, BinaryOfEitherOrderHasAnyTypesAndMore) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const Mesh mesh = parse(mixed(order));
    EXPECT_EQ(mesh.faces, (Faces{{0, 1, 2}, {0, 2, 3, 4}}));
    ASSERT_EQ(mesh.vertices.cols(), 5);
    for (Index i = 0; i < 5; ++i) {
      EXPECT_EQ(mesh.vertices(0, i), -300.0 * static_cast<double>(i));
      EXPECT_EQ(mesh.vertices(1, i), static_cast<double>(0.1F * static_cast<float>(i * i)));
      EXPECT_EQ(mesh.vertices(2, i), 1e-3 * static_cast<double>(i));
      EXPECT_EQ(mesh.texture_coordinates(0, i), 0.125 * static_cast<double>(i));
      EXPECT_EQ(mesh.texture_coordinates(1, i), 0.25);
    }
    EXPECT_EQ(mesh.texture_corners, mesh.faces);
    EXPECT_TRUE(mesh.lines.empty());
  }
}

TEST(Ply, BinaryThatIsCutOffAnywhereIsRefused) {
  const std::string whole = mixed(std::endian::big);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW(parse(whole.substr(0, size)), InputError) << size;
  }
  EXPECT_THROW(parse(whole + "x"), InputError);
}

TEST(Ply, TextureCoordinatesHaveAnyOfTheirNames) {
  for (const auto& [u, v] :
       {std::pair{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}) {
    std::string text = replaced(
        square, "property float z\n",
        "property float z\nproperty float " + std::string(u) + "\nproperty float " + v + "\n");
    for (const char* vertex :
         {"0 0 0\n", "0.5 0.25 0\n", "1 0 0\n", "0 0 1\n", "0.5 0 1\n", "1 0 1\n"}) {
      const std::string line = vertex;
      text = replaced(text, "\n" + line, "\n" + line.substr(0, line.size() - 1) + " 0.75 -2\n");
    }
    const Mesh mesh = parse(text);
    ASSERT_EQ(mesh.texture_coordinates.cols(), 6) << u;
    EXPECT_EQ(mesh.texture_coordinates.col(5), Eigen::Vector2d(0.75, -2)) << u;
    EXPECT_TRUE(mesh.splits_seams);
  }
}

// Seams

/// Two unit squares side by side, the edge between them written twice: 1 2 and 4 7; z lifts the
/// second square.
Mesh split(double gap = 0) {
  Mesh mesh;
  mesh.vertices.resize(3, 8);
  mesh.vertices << 0, 1, 1, 0, 1, 2, 2, 1,  //
      0, 0, 0, 0, gap, 0, 0, gap,           //
      0, 0, 1, 1, 0, 0, 1, 1;
  mesh.faces = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  mesh.texture_corners = mesh.faces;
  mesh.splits_seams = true;
  return mesh;
}

TEST(Seams, AreWeldedTheSameInBothPosesAndRemarkedOn) {
  Mesh mesh = split(), pose = split();
  pose.vertices.row(1) = pose.vertices.row(0).array().square();
  weld_seams(mesh, pose);
  for (const Mesh& each : {mesh, pose}) {
    EXPECT_EQ(each.faces, (Faces{{0, 1, 2, 3}, {1, 4, 5, 2}}));
    EXPECT_EQ(each.file_vertices, (std::vector<Index>{0, 1, 2, 3, 1, 4, 5, 2}));
    EXPECT_EQ(each.texture_corners, split().faces) << "texture points stay those of the file";
    ASSERT_EQ(each.remarks.size(), 1u);
    EXPECT_NE(each.remarks[0].find("2 of the file's 8 vertices"), std::string::npos);
  }
  EXPECT_EQ(mesh.vertices.col(5), Eigen::Vector3d(2, 0, 1));
  EXPECT_EQ(pose.vertices.col(4), Eigen::Vector3d(2, 4, 0));
}

TEST(Seams, ThatOpenInThePoseStayOpen) {
  Mesh mesh = split(), pose = split(1e-7);
  weld_seams(mesh, pose);
  EXPECT_EQ(mesh.vertices.cols(), 8);
  EXPECT_EQ(mesh.faces, split().faces);
  EXPECT_TRUE(mesh.file_vertices.empty());
  EXPECT_TRUE(mesh.remarks.empty());
}

TEST(Seams, OfAFileThatSplitsNothingStayOpen) {
  Mesh mesh = split(), pose = split();
  mesh.splits_seams = pose.splits_seams = false;
  weld_seams(mesh, pose);
  EXPECT_EQ(mesh.vertices.cols(), 8);
}

TEST(Seams, AreWeldedWhicheverWayTheFacesRun) {
  Mesh mesh = split();
  std::reverse(mesh.faces[1].begin(), mesh.faces[1].end());
  Mesh pose = mesh;
  weld_seams(mesh, pose);
  EXPECT_EQ(mesh.vertices.cols(), 6);
}

TEST(Seams, PartsThatTouchInACornerStayApart) {
  Mesh mesh = split();
  mesh.vertices.row(2).tail(4).array() += 1;  // vertex 4 lies on 2, no edge on another
  Mesh pose = mesh;
  weld_seams(mesh, pose);
  EXPECT_EQ(mesh.vertices.cols(), 8);
}

TEST(Seams, AFaceUponAnotherStaysApart) {
  Mesh mesh = split();
  mesh.vertices.rightCols(4) = mesh.vertices.leftCols(4);
  Mesh pose = mesh;
  weld_seams(mesh, pose);
  EXPECT_EQ(mesh.vertices.cols(), 8);
}

TEST(Seams, WhereThreeFacesMeetStayApart) {
  Mesh mesh = split();
  const Points two = mesh.vertices;
  mesh.vertices.resize(3, 12);
  mesh.vertices << two, two.rightCols(4);
  mesh.vertices.row(1).tail(4) << 0, 1, 1, 0;
  mesh.faces.push_back({8, 9, 10, 11});
  Mesh pose = mesh;
  weld_seams(mesh, pose);
  EXPECT_EQ(mesh.vertices.cols(), 12);
}

TEST(Seams, OfATriangleSoupAreAllWelded) {
  constexpr Index size = 7;
  Mesh mesh;
  std::vector<double> at;
  const auto corner = [&](Index i, Index j) {
    at.insert(at.end(),
              {static_cast<double>(i), 0.1 * static_cast<double>(i * j), static_cast<double>(j)});
    return std::ssize(at) / 3 - 1;
  };
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      mesh.faces.push_back({corner(i, j), corner(i, j + 1), corner(i + 1, j + 1)});
      mesh.faces.push_back({corner(i, j), corner(i + 1, j + 1), corner(i + 1, j)});
    }
  }
  mesh.vertices = Eigen::Map<const Points>(at.data(), 3, std::ssize(at) / 3);
  mesh.splits_seams = true;
  const Mesh soup = mesh;
  Mesh pose = mesh;
  weld_seams(mesh, pose);
  EXPECT_EQ(mesh.vertices.cols(), (size + 1) * (size + 1));
  for (Index i = 0; i < soup.vertices.cols(); ++i) {
    EXPECT_EQ(mesh.vertices.col(mesh.file_vertices[static_cast<std::size_t>(i)]),
              soup.vertices.col(i));
  }
}

TEST(Poses, MayRunRoundAFaceTheOtherWayButNotFromAnotherCorner) {
  const Mesh mesh = parse(square);
  Mesh pose = mesh;
  std::reverse(pose.faces[1].begin(), pose.faces[1].end());
  EXPECT_NO_THROW(require_same_faces(mesh, "a.ply", pose, "b.ply"));
  pose.faces[1] = {4, 5, 2, 1};
  try {
    require_same_faces(mesh, "a.ply", pose, "b.ply");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "b.ply:18: the face 4 5 2 1 is 1 4 5 2 in a.ply: the vertices stand in another order, "
        "or it is no pose of the same mesh; export both with the order of vertices kept");
  }
}

}  // namespace
}  // namespace nuno
