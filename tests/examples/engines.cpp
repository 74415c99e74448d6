#include <nuno/engines.h>

#include <gtest/gtest.h>

#include "arch.h"

namespace nuno {

TEST(Example, AnEngineIsMadeByItsName) {
  const SceneFile file = make_scene_file("arch", arch());
  const auto backend = make_backend("box2d", file);
  EXPECT_EQ(backend->name(), "box2d");
  EXPECT_THROW(make_backend("bullet", file), InputError);  // flies sheets only
}

}  // namespace nuno
