#include <nuno/materials.h>

#include <gtest/gtest.h>

namespace nuno {
namespace {

// The worked example of docs/materials.md, to the digits that stand there.
TEST(Materials, ConvertKawabatasUnits) {
  const NamedMaterial* const denim = find_material("denim");
  ASSERT_NE(denim, nullptr);
  EXPECT_NEAR(denim->cloth.stretch_stiffness, 9429, 1);
  EXPECT_NEAR(denim->cloth.shear_stiffness, 220, 0.5);
  EXPECT_NEAR(denim->cloth.bending_stiffness, 5.69e-6, 1e-8);
}

TEST(Materials, AreFoundByNameAlone) {
  EXPECT_EQ(material_names(), "cotton, silk, denim, wool");
  for (const NamedMaterial& each : named_materials()) EXPECT_EQ(find_material(each.name), &each);
  EXPECT_EQ(find_material("Denim"), nullptr);
  EXPECT_EQ(find_material(""), nullptr);
}

}  // namespace
}  // namespace nuno
