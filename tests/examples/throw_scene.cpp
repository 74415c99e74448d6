#include <nuno/throw_scene.h>

#include <gtest/gtest.h>

#include "arch.h"

namespace nuno {

TEST(Example, AThrowIsADampedMorph) {
  const Shapes shapes{arch().initial, arch().target};
  ThrowRequest request;
  request.arrival_time = 1;
  const AnyScene scene = throw_scene(request, shapes, "arch");
  EXPECT_EQ(scene_of(scene).reference, Reference::morph);
  EXPECT_GT(scene_of(scene).damping_ratio, 0);
}

}  // namespace nuno
