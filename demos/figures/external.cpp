#include "external.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <sstream>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace nuno {
namespace {

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
                 const std::function<void(std::FILE*)>& write, std::FILE* out) {
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
  std::exception_ptr failure;
  {
    const File pipe(fdopen(input[1], "w"));
    try {
      write(pipe.get());
    } catch (...) {  // the child is waited for whatever happens
      failure = std::current_exception();
    }
  }
  int status = 0;
  while (waitpid(id, &status, 0) < 0 && errno == EINTR) {
  }
  if (failure) std::rethrow_exception(failure);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw ExternalError(fmt::format("{} failed: {}", arguments[0], last_line(complaints.get())));
  }
}

void require_png() { require_program("rsvg-convert", "librsvg2-bin", "PNG"); }

void write_png(const std::string& svg, std::FILE* out) {
  run_program(
      {"rsvg-convert", "--unlimited", "--zoom", fmt::format("{}", png_scale)},
      [&](std::FILE* input) { std::fwrite(svg.data(), 1, svg.size(), input); }, out);
}

}  // namespace nuno
