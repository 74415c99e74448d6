#include <nuno/glb_file.h>

#include <gtest/gtest.h>

#include <nuno/output.h>

namespace nuno {

TEST(Example, AMotionIsWrittenAsBinaryGltf) {
  Mesh mesh;
  mesh.vertices = Points{{0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  mesh.faces = {{0, 1, 2}};
  const File file(std::tmpfile());
  write_glb(file.get(), "cloth", mesh, {0, 0.5}, {mesh.vertices, 2 * mesh.vertices});
  std::rewind(file.get());
  std::string magic(4, ' ');
  EXPECT_EQ(std::fread(magic.data(), 1, 4, file.get()), 4U);
  EXPECT_EQ(magic, "glTF");
}

}  // namespace nuno
