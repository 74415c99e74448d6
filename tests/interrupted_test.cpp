// Every command that writes, killed at random moments: an output is the old file or the new one,
// and nothing else is left but by what cannot be caught.

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "program.h"

namespace nuno {
namespace {

constexpr int few_moments = 4;  // at which each command is killed; NUNO_MOMENTS: others

struct Command {
  const char* name;
  std::vector<std::string> arguments;  ///< words in capitals stand for paths
  const char* needs = "";              ///< a program that it runs
};

const std::vector<Command> commands = {
    {"Simulate", {"simulate", "SCENE", "--out", "OUT/result.json"}},
    {"Optimize", {"optimize", "SCENE", "--out", "OUT/flight.glb"}},
    {"Refine", {"optimize", "SCENE", "--refine", "--out", "OUT/flight.usda"}},
    {"Throw", {"throw", "DRAWING", "--time", "0.5", "--out", "OUT/frame.####.obj"}},
    {"ThrowOfASheet", {"throw", "MESH", "MESH", "--time", "0.5", "--out", "OUT/cloth.pc2"}},
    {"SimulateASheet", {"simulate", "SHEET", "--out", "OUT/cloth.mdd"}},
    {"OptimizeASheet", {"optimize", "SHEET", "--out", "OUT/result.json"}},
    {"RefineASheet", {"optimize", "SHEET", "--refine", "--out", "OUT/cloth.glb"}},
    {"Compare", {"compare", "SCENE", "--out", "OUT"}},
    {"CompareASheet", {"compare", "SHEET", "--out", "OUT"}},
    {"Batch", {"batch", "SHOTS", "--out", "OUT"}},
    {"RenderSvg", {"render", "RESULT", "--out", "OUT/flight.svg"}},
    {"RenderASheet", {"render", "SHEET", "--out", "OUT/cloth.svg"}},
    {"RenderPng", {"render", "RESULT", "--out", "OUT/flight.png"}, "rsvg-convert"},
    {"RenderFilm", {"render", "RESULT", "--out", "OUT/flight.mp4"}, "ffmpeg"},
    {"Figures", {"figures", "--out", "OUT"}, "rsvg-convert"},
};

void PrintTo(const Command& command, std::ostream* out) { *out << command.name; }

/// A report without the times in the cells of its table.
std::string without_times(const std::string& page) {
  std::string result;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t cell = std::min(page.find("<td>", at), page.size());
    const std::size_t end = std::min(page.find("</td>", cell), page.size());
    const std::string text = page.substr(cell, end - cell);
    result.append(page, at, cell - at);
    if (!text.ends_with(" s") && !text.ends_with("ms") && !text.ends_with("µs")) result += text;
    at = end;
    if (at < page.size()) {
      result += "</td>";
      at += 5;
    }
  }
  return result;
}

class Interrupted : public Program, public testing::WithParamInterface<Command> {
 protected:
  using Files = std::map<std::string, std::string>;  ///< what is in them, by path

  Files files() const {
    Files result;
    for (const auto& entry : fs::recursive_directory_iterator(in_folder("outputs"))) {
      if (entry.is_directory()) continue;
      result[fs::relative(entry.path(), in_folder("outputs"))] =
          without_times(without_seconds(read_text(entry.path())));
    }
    return result;
  }

  std::vector<std::string> arguments() {
    Json scene = right_scene();
    scene["frames_per_second"] = 2000;  // the file takes its time
    write_text(in_folder("scene.json"), scene.dump());
    write_text(in_folder("mesh.obj"), "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 3 2\nf 2 3 4\n");
    write_text(in_folder("sheet.json"),
               R"({"nuno_scene": 1, "arrival_time": 0.3, "initial": )"
               R"("mesh.obj", "target": "bent.obj", "reference": "morph"})");
    write_text(in_folder("bent.obj"),
               "v 1 0 0\nv 2 0 0\nv 1 0.2 0.9\nv 2 0.3 0.9\nf 1 3 2\nf 2 3 4\n");
    fs::create_directory(in_folder("shots"));
    for (const char* name : {"a", "b", "c"}) {
      write_text(in_folder("shots") / (std::string(name) + ".json"), scene.dump());
    }
    write_text(in_folder("drawing.svg"),
               R"(<svg xmlns="http://www.w3.org/2000/svg"><path id="initial" d="M0 0H90"/>)"
               R"(<path id="target" d="M200 0q40 -30 80 0"/></svg>)");
    std::vector<std::string> words = GetParam().arguments;
    for (std::string& word : words) {
      if (word == "SCENE") word = in_folder("scene.json");
      if (word == "SHEET") word = in_folder("sheet.json");
      if (word == "SHOTS") word = in_folder("shots");
      if (word == "MESH") word = in_folder("mesh.obj");
      if (word == "DRAWING") word = in_folder("drawing.svg");
      if (word == "RESULT") word = in_folder("result.json");
      if (word.starts_with("OUT")) word.replace(0, 3, in_folder("outputs").string());
    }
    if (GetParam().arguments[1] == "RESULT") {
      EXPECT_EQ(
          nuno({"optimize", scenes / "letter-z.json", "--out", in_folder("result.json")}).status,
          0);
    }
    return words;
  }
};

TEST_P(Interrupted, LeavesTheOldFileOrTheNew) {
  if (*GetParam().needs && !is_installed(GetParam().needs)) {
    GTEST_SKIP() << GetParam().needs << " is not installed";
  }
  const std::vector<std::string> words = arguments();
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(nuno(words).status, 0);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
  const Files fresh = files();
  ASSERT_FALSE(fresh.empty());

  std::mt19937 random(7);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same moments each time
  std::uniform_real_distribution<double> moment(0, 1.1 * whole.count());
  constexpr std::array signals = {SIGTERM, SIGINT, SIGKILL};
  const int count = wished("NUNO_MOMENTS", few_moments);
  int ended = 0;
  for (int i = 0; i < count; ++i) {
    for (const auto& [name, text] : fresh) write_text(output(name), "old");
    const int signal = signals[random() % signals.size()];
    const Process process(words, in_folder("stdout"), in_folder("stderr"));
    std::this_thread::sleep_for(std::chrono::duration<double>(moment(random)));
    process.send(signal);
    const int status = process.wait();
    EXPECT_TRUE(status == 0 || status == 1 || status == -signal) << status;
    ended += status != 0;
    for (const auto& [name, text] : files()) {
      const auto wanted = fresh.find(name);
      if (wanted == fresh.end()) {
        EXPECT_EQ(signal, SIGKILL) << "leaves " << name;
        fs::remove(output(name));
      } else if (text != "old") {
        EXPECT_EQ(text, wanted->second) << name << " is neither old nor new";
      }
    }
  }
  std::printf("%s, which takes %.2f s: killed at %d of %d moments\n", GetParam().name,
              whole.count(), ended, count);
}

INSTANTIATE_TEST_SUITE_P(Commands, Interrupted, testing::ValuesIn(commands),
                         [](const auto& command) { return std::string(command.param.name); });

}  // namespace
}  // namespace nuno
