#include <nuno/input.h>

#include <gtest/gtest.h>

#include <nuno/scene.h>

namespace nuno {

TEST(Example, AFileThatIsNotThereIsNamed) {
  EXPECT_EQ(name_of_input("-"), "standard input");
  try {
    read_file("no/such/file", "no/such/file", "a mesh");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find("no/such/file"), 0U) << error.what();
  }
}

}  // namespace nuno
