// The scenes that come with the program, and its help.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "program.h"

namespace nuno {
namespace {

TEST_F(Program, SolvesEverySceneThatComesWithIt) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(scenes)) {
    if (entry.path().extension() != ".json") continue;
    const Json result = simulated({"optimize", entry.path()});
    EXPECT_LT(result["error"]["relative"], 0.1) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 10);
}

TEST_F(Program, HelpsOnItsCommandsAndTellsItsVersion) {
  const std::string version = nuno({"--version"}).out;
  EXPECT_TRUE(version.starts_with("nuno "));
  for (const char* part : {"Eigen3 3.", "box2d ", "bullet "}) {
    EXPECT_NE(version.find(part), std::string::npos) << part;
  }
  const Outcome help = nuno({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const std::string command : {"simulate", "optimize", "compare"}) {
    EXPECT_NE(help.out.find(command), std::string::npos);
    const Outcome run = nuno({command, "--help"});
    EXPECT_EQ(run.status, 0);
    EXPECT_NE(run.out.find("--out"), std::string::npos);
    for (const std::string choice : {"\"hold\"", "\"morph\"", "\"damping_ratio\"", "\"settle\""}) {
      EXPECT_NE(run.out.find(choice), std::string::npos) << command << ": " << choice;
    }
    EXPECT_EQ(run.err, "");
  }
}

}  // namespace
}  // namespace nuno
