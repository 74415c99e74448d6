// Animations as packages read them: every number of a file read back by the test's own reader.
#include <nuno/animation.h>

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <locale>
#include <map>
#include <sstream>

#include "temporary_folder.h"

namespace nuno {
namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Two triangles with a seam of their texture; the frames are scaled and moved.
Animation two_triangles() {
  Animation animation;
  animation.name = "2 triangles";
  animation.mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  animation.mesh.lines = {1, 2};
  animation.mesh.texture_coordinates = Points{{0, 1, 1, 0, 0.5}, {0, 0, 1, 1, 0.25}};
  animation.mesh.texture_corners = {{0, 1, 2}, {4, 2, 3}};
  animation.frames_per_second = 25;
  animation.first_frame = 101;
  const Points square{{0, 1.0 / 3, 1, 0}, {1e-3, -2, 0.1, 5}, {0, 0, -1.5, -1}};
  animation.mesh.vertices = square;
  for (int k = 0; k < 3; ++k) {
    animation.times.push_back(k / 25.0);
    animation.positions.push_back((1 + 0.1 * k) * square);
  }
  return animation;
}

/// Numbers of 4 bytes one after another, in either order of bytes.
class Reader {
 public:
  Reader(const std::filesystem::path& path, std::streamoff start, bool big)
      : file_(path, std::ios::binary), big_(big) {
    file_.seekg(start);
  }

  std::uint32_t word() {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) {
      value |= static_cast<std::uint32_t>(file_.get()) << 8 * (big_ ? 3 - i : i);
    }
    EXPECT_TRUE(file_.good());
    return value;
  }
  float number() { return std::bit_cast<float>(word()); }
  bool at_end() { return file_.peek() == std::ifstream::traits_type::eof(); }

  void expect(const std::vector<Points>& shapes) {
    for (const Points& shape : shapes) {
      for (const double x : shape.reshaped()) EXPECT_EQ(number(), static_cast<float>(x));
    }
  }

 private:
  std::ifstream file_;
  bool big_;
};

TEST(Animation, AsPc2IsLittleEndianWithAllItsFrames) {
  const TemporaryFolder folder;
  const Animation animation = two_triangles();
  write_animation(folder / "a.pc2", animation);
  EXPECT_TRUE(bytes_of(folder / "a.pc2").starts_with(std::string("POINTCACHE2\0", 12)));
  Reader reader(folder / "a.pc2", 12, false);
  EXPECT_EQ(reader.word(), 1u);  // version
  EXPECT_EQ(reader.word(), 4u);  // points
  EXPECT_EQ(reader.number(), 101.0F);
  EXPECT_EQ(reader.number(), 1.0F);  // frames per sample
  EXPECT_EQ(reader.word(), 3u);
  reader.expect(animation.positions);
  EXPECT_TRUE(reader.at_end());
}

TEST(Animation, AsACacheHasTheVerticesOfTheMeshsFileWithTheirCopies) {
  const TemporaryFolder folder;
  Animation animation = two_triangles();
  animation.mesh.file_vertices = {0, 1, 2, 0, 2, 3};
  write_animation(folder / "a.pc2", animation);
  Reader reader(folder / "a.pc2", 16, false);
  EXPECT_EQ(reader.word(), 6u);
  for (int k = 0; k < 3; ++k) reader.word();
  const Points& first = animation.positions.front();
  reader.expect({first(Eigen::all, {0, 1, 2, 0, 2, 3})});
}

TEST(Animation, AsMddIsBigEndianWithTheTimesOfItsFrames) {
  const TemporaryFolder folder;
  const Animation animation = two_triangles();
  write_animation(folder / "a.mdd", animation);
  Reader reader(folder / "a.mdd", 0, true);
  EXPECT_EQ(reader.word(), 3u);
  EXPECT_EQ(reader.word(), 4u);
  for (const double time : animation.times) EXPECT_EQ(reader.number(), static_cast<float>(time));
  reader.expect(animation.positions);
  EXPECT_TRUE(reader.at_end());
}

TEST(Animation, AsObjIsAFileForEachFrameWithTheMeshAsItCame) {
  const TemporaryFolder folder;
  const Animation animation = two_triangles();
  write_animation(folder / "a-####.obj", animation);
  for (std::size_t k = 0; k < 3; ++k) {
    const Mesh mesh = read_mesh(folder / ("a-010" + std::to_string(k + 1) + ".obj"));
    EXPECT_EQ(mesh.vertices, animation.positions[k]);
    EXPECT_EQ(mesh.faces, animation.mesh.faces);
    EXPECT_EQ(mesh.texture_coordinates, animation.mesh.texture_coordinates);
    EXPECT_EQ(mesh.texture_corners, animation.mesh.texture_corners);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 3);
}

/// The numbers between the first [ after `name` and its ].
std::vector<double> numbers_after(const std::string& text, const std::string& name) {
  const std::size_t from = text.find('[', text.find(name)), to = text.find(']', from);
  std::string inside = text.substr(from + 1, to - from - 1);
  for (char& c : inside) {
    if (c == ',' || c == '(' || c == ')') c = ' ';
  }
  std::istringstream words(inside);
  std::vector<double> result;
  for (double x = 0; words >> x;) result.push_back(x);
  return result;
}

TEST(Animation, AsUsdaHasASampleForEachFrameAtItsTime) {
  const TemporaryFolder folder;
  Animation animation = two_triangles();
  animation.times.back() = 1.75 / 25;  // an arrival between two frames
  write_animation(folder / "a.usda", animation);
  const std::string text = bytes_of(folder / "a.usda");
  EXPECT_TRUE(text.starts_with("#usda 1.0\n"));
  for (const char* line : {"upAxis = \"Y\"", "metersPerUnit = 1\n", "timeCodesPerSecond = 25\n",
                           "startTimeCode = 101\n", "endTimeCode = 102.75\n",
                           "def Xform \"_2_triangles\"", "interpolation = \"faceVarying\""}) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
  EXPECT_EQ(numbers_after(text, "faceVertexCounts = "), (std::vector<double>{3, 3}));
  EXPECT_EQ(numbers_after(text, "faceVertexIndices = "), (std::vector<double>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(numbers_after(text, "primvars:st:indices = "), (std::vector<double>{0, 1, 2, 4, 2, 3}));
  const std::string points = text.substr(text.find("point3f[] points.timeSamples"));
  const char* codes[] = {"101: ", "102: ", "102.75: "};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double> numbers = numbers_after(points, codes[k]);
    ASSERT_EQ(numbers.size(), 12u);
    for (Index i = 0; i < 12; ++i) {
      EXPECT_EQ(static_cast<float>(numbers[static_cast<std::size_t>(i)]),
                static_cast<float>(animation.positions[k].reshaped()[i]));
    }
  }
  const std::vector<double> bounds =
      numbers_after(text, "101: ");  // of the extent, the first there
  EXPECT_EQ(bounds.front(), 0);
  EXPECT_EQ(bounds.back(), 0);
  EXPECT_EQ(static_cast<float>(bounds[1]), -2.0F);
}

TEST(Animation, ThatCountsFramesArrivesAtAWholeOne) {
  require_animation("a.pc2", 1.2, 25);
  require_animation("a.glb", 1.2, 24);  // these tell a frame's own time
  require_animation("a.usda", 1.2, 24);
  try {
    require_animation("a.pc2", 1.2, 24);
    FAIL() << "28.8 frames";
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "--out: a.pc2: counts in whole frames, and 1.2 s are 28.8 frames at 24 per second; "
        "arrive at 1.208333333 s");
  }
  EXPECT_THROW(require_animation("a.obj", 1, 24), InputError);  // no # for the number
  require_animation("a-#.obj", 1, 24);
}

/// Numbers as they are written in half of Europe.
class CommaForPoint : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Animation, IsTheSameWhereNumbersHaveACommaForThePoint) {
  const TemporaryFolder folder;
  Animation animation = two_triangles();
  animation.first_frame = 1001;
  const auto write = [&] {
    std::map<std::string, std::string> files;
    write_animation(folder / "a-#.obj", animation);
    files["a-1001.obj"] = bytes_of(folder / "a-1001.obj");
    for (const std::string name : {"a.usda", "a.glb", "a.pc2", "a.mdd"}) {
      write_animation(folder / name, animation);
      files[name] = bytes_of(folder / name);
    }
    return files;
  };
  const auto plain = write();
  const std::locale before = std::locale::global({std::locale(), new CommaForPoint});
  const auto there = write();
  const Mesh mesh = read_mesh(folder / "a-1002.obj");
  std::locale::global(before);
  for (const auto& [name, bytes] : plain) {
    EXPECT_FALSE(bytes.empty()) << name;
    EXPECT_EQ(there.at(name), bytes) << name;
  }
  EXPECT_EQ(mesh.vertices, animation.positions[1]);
}

TEST(Animation, OfAChainIsARibbonOfItsWidth) {
  const Points shape{{0, 1, 1.5}, {0, 0, 2}};
  const Mesh mesh = ribbon_mesh(shape, 0.25);
  ASSERT_EQ(mesh.vertices.cols(), 6);
  for (Index i = 0; i < 3; ++i) {
    EXPECT_EQ(mesh.vertices.col(i).head(2), shape.col(i));
    EXPECT_EQ(mesh.vertices.col(3 + i) - mesh.vertices.col(i), Eigen::Vector3d(0, 0, 0.25));
  }
  EXPECT_EQ(mesh.faces, (Faces{{0, 1, 4, 3}, {1, 2, 5, 4}}));
  EXPECT_EQ(mesh.texture_coordinates.row(0), (Eigen::RowVectorXd{{0, 0.5, 1, 0, 0.5, 1}}));
}

}  // namespace
}  // namespace nuno
