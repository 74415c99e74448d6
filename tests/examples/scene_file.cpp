#include <nuno/scene_file.h>

#include <gtest/gtest.h>

#include "arch.h"

namespace nuno {

TEST(Example, ASceneIsReadFromItsText) {
  const ChainScene scene = parse_scene(to_json(arch()), "text");
  EXPECT_EQ(scene.target, arch().target);
  EXPECT_THROW(parse_scene("{\"nuno_scene\": 1}", "text"), InputError);
}

}  // namespace nuno
