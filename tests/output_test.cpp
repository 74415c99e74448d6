// Where results go: files, links, devices, standard output; whole or not at all.

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "program.h"

namespace nuno {
namespace {

class Output : public Program {};

TEST_F(Output, ToStandardOutputIsTheFileAndNothingElse) {
  const std::vector<std::string> arguments = {"simulate", scene("hanging-to-arch-32"), "--alpha",
                                              "0.0151", "--out"};
  auto to_file = arguments, to_stdout = arguments;
  to_file.push_back(output("result.json"));
  to_stdout.push_back("-");
  const Outcome file_run = nuno(to_file);
  const Outcome stdout_run = nuno(to_stdout);
  ASSERT_EQ(file_run.status, 0) << file_run.err;
  ASSERT_EQ(stdout_run.status, 0) << stdout_run.err;
  EXPECT_EQ(stdout_run.out, read_text(output("result.json")));
  EXPECT_EQ(stdout_run.err, file_run.out) << "the summary for people moves to standard error";
  EXPECT_EQ(file_run.err, "") << "no progress where there is no terminal";
}

TEST_F(Output, ReplacesAFileAndLeavesNothingBesideIt) {
  write_text(output("result.json"), std::string(1'000'000, 'x'));
  fs::permissions(output("result.json"), fs::perms{0600});
  ASSERT_EQ(nuno({"simulate", scene("s-curve-32"), "--out", output("result.json")}).status, 0);
  EXPECT_EQ(read_json(output("result.json"))["nuno_result"], 1);
  EXPECT_EQ(outputs(), std::set<std::string>{"result.json"});
  EXPECT_EQ(fs::status(output("result.json")).permissions(), fs::perms{0600});
}

TEST_F(Output, ThroughALinkKeepsTheLink) {
  write_text(in_folder("real.json"), "old");
  fs::create_symlink(in_folder("real.json"), output("link.json"));
  ASSERT_EQ(nuno({"simulate", scene("s-curve-32"), "--out", output("link.json")}).status, 0);
  EXPECT_TRUE(fs::is_symlink(output("link.json")));
  EXPECT_EQ(read_json(in_folder("real.json"))["nuno_result"], 1);
}

TEST_F(Output, ToADeviceGoesIntoTheDevice) {
  ASSERT_EQ(nuno({"simulate", scene("s-curve-32"), "--out", "/dev/null"}).status, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(Output, ThatCannotBeWrittenIsExitStatusOneAndNamesIt) {
  for (const std::string& path :
       {output("no/such/folder.json").string(), in_folder("outputs").string(),
        scene("s-curve-32") + "/file.json", std::string("/dev/full")}) {
    const Outcome run = nuno({"simulate", scene("s-curve-32"), "--out", path});
    EXPECT_EQ(run.status, 1) << path;
    EXPECT_TRUE(is_one_line(run.err) && run.err.starts_with(path + ": ")) << run.err;
  }
  EXPECT_TRUE(outputs().empty());
}

TEST_F(Output, FolderThatIsAFileIsExitStatusOne) {
  write_text(output("taken"), "precious");
  const Outcome run = nuno({"compare", scene("s-curve-32"), "--out", output("taken")});
  EXPECT_EQ(run.status, 1);
  EXPECT_TRUE(is_one_line(run.err)) << run.err;
  EXPECT_EQ(read_text(output("taken")), "precious");
}

TEST_F(Output, OnAFullStandardOutputIsExitStatusOne) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--help"},
        {"simulate", scene("s-curve-32")},
        {"simulate", scene("s-curve-32"), "--out", "-"}}) {
    EXPECT_EQ(Process(arguments, "/dev/full", in_folder("stderr")).wait(), 1);
    EXPECT_NE(read_text(in_folder("stderr")).find("standard output: cannot be written"),
              std::string::npos);
  }
}

TEST_F(Output, OfAnInterruptedRunIsNotThere) {
  write_text(output("result.json"), "precious");
  const Process process(
      {"simulate", scene("s-curve-32"), "--time-step", "5e-8", "--out", output("result.json")},
      in_folder("stdout"), in_folder("stderr"));
  std::this_thread::sleep_for(300ms);
  process.send(SIGINT);
  EXPECT_EQ(process.wait(), -SIGINT);
  EXPECT_EQ(read_text(output("result.json")), "precious");
  EXPECT_EQ(outputs(), std::set<std::string>{"result.json"});
}

}  // namespace
}  // namespace nuno
