#include <nuno/output.h>

#include <gtest/gtest.h>

#include <filesystem>

#include "../temporary_folder.h"

namespace nuno {

TEST(Example, AFileIsWrittenWholeOrNotAtAll) {
  const TemporaryFolder folder;
  const std::string path = (folder / "out.txt").string();
  write_output(path, [](std::FILE* file) { std::fputs("done", file); });
  EXPECT_EQ(std::filesystem::file_size(path), 4U);
  EXPECT_THROW(require_writable((folder / "none/out.txt").string()), OutputError);
}

}  // namespace nuno
