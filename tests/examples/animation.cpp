#include <nuno/animation.h>

#include <gtest/gtest.h>

#include <filesystem>

#include "../temporary_folder.h"

namespace nuno {

TEST(Example, AChainIsWrittenAsARibbonInMotion) {
  const Points shape{{0, 1}, {1, 1}};
  const Animation animation{"cloth", ribbon_mesh(shape, 0.2), 24, 1, {0}, {ribbon(shape, 0.2)}};
  const TemporaryFolder folder;
  const std::string path = (folder / "flight.usda").string();
  write_animation(path, animation);
  EXPECT_GT(std::filesystem::file_size(path), 0U);
}

}  // namespace nuno
