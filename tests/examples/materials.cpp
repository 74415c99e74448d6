#include <nuno/materials.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, AMaterialIsFoundByItsName) {
  const NamedMaterial* const silk = find_material("silk");
  ASSERT_TRUE(silk);
  EXPECT_LT(silk->cloth.areal_density, find_material("denim")->cloth.areal_density);
  EXPECT_FALSE(find_material("paper"));
}

}  // namespace nuno
