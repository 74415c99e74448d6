#include "pictures/external.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace nuno {
namespace {

using namespace std::chrono_literals;

bool is_on_path(const std::string& program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path file = std::filesystem::path(folder) / program;
    if (access(file.c_str(), X_OK) == 0 && !std::filesystem::is_directory(file)) return true;
  }
  return false;
}

std::string last_line(std::FILE* file) {
  std::rewind(file);
  std::string line, last;
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
    if (c != '\n') {
      line += static_cast<char>(c);
    } else if (!line.empty()) {
      last = std::exchange(line, "");
    }
  }
  return line.empty() ? last : line;
}

}  // namespace

void require_program(const std::string& program, const std::string& package,
                     const std::string& purpose) {
  if (is_on_path(program)) return;
  throw ExternalError(
      fmt::format("{} needs the program {}, which is not installed: apt-get install {}", purpose,
                  program, package));
}

void run_program(const std::vector<std::string>& arguments,
                 const std::function<void(const Feed&)>& write, std::FILE* out,
                 const std::function<void()>& wait) {
  const File complaints(std::tmpfile());
  std::array<int, 2> input{};
  if (!complaints || pipe2(input.data(), O_CLOEXEC) != 0) {
    throw ExternalError(
        fmt::format("{}: cannot be started: {}", arguments[0], std::strerror(errno)));
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input[0], 0);
  posix_spawn_file_actions_adddup2(&actions, fileno(out), 1);
  posix_spawn_file_actions_adddup2(&actions, fileno(complaints.get()), 2);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&attributes, &signals);  // ours may be held
  sigaddset(&signals, SIGPIPE);
  posix_spawnattr_setsigdefault(&attributes, &signals);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

  std::vector<std::string> words = arguments;
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t id = 0;
  const int error =
      posix_spawnp(&id, arguments[0].c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(input[0]);
  if (error != 0) {
    close(input[1]);
    throw ExternalError(
        fmt::format("{}: cannot be started: {}", arguments[0], std::strerror(error)));
  }
  int status = 0;
  try {
    // Not blocked by a program that takes its time, or nobody could end it.
    fcntl(input[1], F_SETFL, O_NONBLOCK);
    write([&](std::string_view text) {
      while (!text.empty()) {
        const ssize_t taken = ::write(input[1], text.data(), text.size());
        if (taken >= 0) {
          text.remove_prefix(static_cast<std::size_t>(taken));
        } else if (errno == EAGAIN) {
          pollfd pipe{input[1], POLLOUT, 0};
          poll(&pipe, 1, 50);
          wait();
        } else if (errno != EINTR) {
          return;  // it has ended, and will say why
        }
      }
    });
    close(std::exchange(input[1], -1));
    for (auto pause = 1ms; waitpid(id, &status, WNOHANG) == 0; pause = std::min(2 * pause, 50ms)) {
      wait();
      std::this_thread::sleep_for(pause);
    }
  } catch (...) {
    if (input[1] >= 0) close(input[1]);
    kill(id, SIGKILL);
    while (waitpid(id, &status, 0) < 0 && errno == EINTR) {
    }
    throw;
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw ExternalError(fmt::format("{} failed: {}", arguments[0], last_line(complaints.get())));
  }
}

void require_png() { require_program("rsvg-convert", "librsvg2-bin", "PNG"); }

void write_png(const std::string& svg, std::FILE* out) {
  run_program(
      {"rsvg-convert", "--unlimited", "--zoom", fmt::format("{}", png_scale)},
      [&](const Feed& feed) { feed(svg); }, out);
}

}  // namespace nuno
