#include <nuno/scene.h>

#include <gtest/gtest.h>

namespace nuno {

TEST(Example, ASceneIsFilledInAndValidated) {
  ChainScene scene;
  scene.arrival_time = 1;
  scene.initial = Points{{0, 1}, {1, 1}};
  scene.target = Points{{3.0, 3.5, 4.0}, {1.0, 1.4, 1.0}};
  validate(scene, "my scene");
  scene.cloth.mass = -1;
  EXPECT_THROW(validate(scene, "my scene"), InputError);
}

}  // namespace nuno
