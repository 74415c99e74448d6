#pragma once

// The program as a script sees it: exit status, standard output, standard error, files.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "temporary_folder.h"

extern char** environ;

namespace nuno {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using namespace std::chrono_literals;

inline const fs::path scenes = NUNO_SCENES;

/// A scene that comes with the program.
inline std::string scene(const std::string& name) { return (scenes / (name + ".json")).string(); }

/// A scene that is small and right.
inline Json right_scene() {
  return Json::parse(R"({
    "nuno_scene": 1, "particles": 8, "arrival_time": 0.5,
    "initial": [[0, 1], [1, 1]], "target": [[2, 1], [2.5, 1.3], [3, 1]],
    "cloth": {"mass": 0.1}
  })");
}

inline std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline void write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline Json read_json(const fs::path& path) { return Json::parse(read_text(path)); }

inline bool is_one_line(const std::string& text) {
  return !text.empty() && text.find('\n') == text.size() - 1;
}

/// A text without what each run makes anew: how long it took.
inline std::string without_seconds(const std::string& text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::string word = "\"seconds\":";
    const std::size_t found = std::min(text.find(word, at), text.size());
    result.append(text, at, found - at);
    at = found == text.size() ? found : text.find_first_of(",}", found);
  }
  return result;
}

/// A number that the environment may wish larger, for a run that is to be thorough once.
inline int wished(const char* variable, int otherwise) {
  const char* const text = std::getenv(variable);
  return text ? std::atoi(text) : otherwise;
}

/// A path as one word of a shell, whatever TMPDIR is called.
inline std::string word(const std::string& path) {
  std::string quoted = "'";
  for (const char c : path) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// Whether a program that ours runs is there.
inline bool is_installed(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

/// A run of the program that has ended.
struct Outcome {
  int status = -1;  ///< exit status, or minus the signal that killed it
  std::string out, err;
};

/// A run of the program, its output in two files; `out` may also be a device.
class Process {
 public:
  Process(const std::vector<std::string>& arguments, const fs::path& out, const fs::path& err) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    std::vector<std::string> words = arguments;
    words.insert(words.begin(), NUNO_PROGRAM);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if (posix_spawn(&id_, NUNO_PROGRAM, &actions, nullptr, argv.data(), environ) != 0) {
      throw std::runtime_error("cannot start " NUNO_PROGRAM);
    }
    posix_spawn_file_actions_destroy(&actions);
  }

  void send(int signal) const { kill(id_, signal); }

  /// Until it has said that the signal does not kill it, or has ended.
  void wait_until_it_catches(int signal) const {
    for (int i = 0; i < 10'000; ++i) {
      std::ifstream status("/proc/" + std::to_string(id_) + "/status");
      std::string line;
      while (std::getline(status, line) && !line.starts_with("SigCgt:")) {
      }
      if (line.empty() || (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1)) return;
      std::this_thread::sleep_for(1ms);
    }
  }

  /// Exit status, or minus the signal. A program that hangs is killed after ten minutes: a
  /// machine that is busy takes some for the work of a second.
  int wait() const {
    const auto deadline = std::chrono::steady_clock::now() + 600s;
    int status = 0;
    while (waitpid(id_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > deadline) kill(id_, SIGKILL);
      std::this_thread::sleep_for(1ms);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t id_ = 0;
};

/// The program, and a folder of its own for every test.
class Program : public testing::Test {
 protected:
  Program() { fs::create_directory(folder_ / "outputs"); }

  fs::path in_folder(const std::string& name) const { return folder_ / name; }

  /// A place for an output: nothing else is in its folder.
  fs::path output(const std::string& name) const { return folder_ / "outputs" / name; }

  std::set<std::string> outputs() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / "outputs")) {
      names.insert(entry.path().filename());
    }
    return names;
  }

  Outcome nuno(const std::vector<std::string>& arguments) const {
    const fs::path out = folder_ / "stdout", err = folder_ / "stderr";
    Outcome run;
    run.status = Process(arguments, out, err).wait();
    run.out = read_text(out);
    run.err = read_text(err);
    return run;
  }

  /// The run is refused as bad input, in one line that begins with `start` and that a person and a
  /// terminal can read; it shows the value and says the rule.
  static void expect_refusal(const Outcome& run, const std::string& start, const std::string& value,
                             const std::string& rule) {
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_TRUE(is_one_line(run.err)) << run.err;
    EXPECT_TRUE(run.err.starts_with(start)) << run.err << "not after " << start;
    EXPECT_NE(run.err.find(value), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(rule), std::string::npos) << run.err;
    EXPECT_LT(run.err.size(), 600u) << "a line that a person can read";
    for (const char c : run.err.substr(0, run.err.size() - 1)) {
      EXPECT_GE(static_cast<unsigned char>(c), ' ') << "no code for a terminal";
    }
  }

  Json simulated(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--out", "-"});
    const Outcome run = nuno(arguments);
    EXPECT_EQ(run.status, 0) << run.err;
    return Json::parse(run.out);
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace nuno
