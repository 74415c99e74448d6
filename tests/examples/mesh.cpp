#include <nuno/mesh.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, AMeshIsReadFromItsText) {
  const Mesh mesh = parse_obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", "square.obj");
  EXPECT_EQ(mesh.vertices.cols(), 4);
  require_sheet(mesh, "square.obj");
  EXPECT_EQ(triangulated(mesh.vertices).size(), 2U);
}

}  // namespace nuno
