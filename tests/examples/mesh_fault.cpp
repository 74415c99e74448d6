#include <nuno/mesh_fault.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, AFaceThatNamesAVertexTwiceIsAFault) {
  const Points corners{{0, 1, 1, 0}, {0, 0, 0, 0}, {0, 0, 1, 1}};
  EXPECT_FALSE(mesh_fault(corners, {{0, 1, 2, 3}}));
  const auto fault = mesh_fault(corners, {{0, 1, 2}, {0, 2, 2}});
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->at, MeshFault::At::face);
  EXPECT_EQ(fault->number, 1);
}

}  // namespace nuno
