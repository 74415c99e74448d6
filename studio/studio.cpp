// `nuno studio`: the page, and the program behind it, on this machine alone.

#include "studio/studio.h"

#include <fmt/format.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <nuno/output.h>
#include "studio/server.h"

namespace nuno {
namespace {

/// Runs the desktop's opener, where there is a desktop.
void open_browser(const std::string& address) {
  const auto is_set = [](const char* name) {
    const char* const value = std::getenv(name);
    return value && *value;
  };
#ifdef __APPLE__
  const char* const opener = "open";
#else
  const char* const opener = "xdg-open";
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) return;
#endif
  std::string program = opener, argument = address;
  std::array<char*, 3> arguments = {program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_RDWR, 0);
  }
  pid_t child = 0;
  // Without an opener the printed address does.
  posix_spawnp(&child, opener, &quiet, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
}

/// Large answers go back to the system once they are sent, and into no store of each thread.
void keep_little_memory() {
#ifdef __GLIBC__
  mallopt(M_ARENA_MAX, 2);
  mallopt(M_MMAP_THRESHOLD, 256 * 1024);
#endif
}

}  // namespace

void serve_studio(const StudioOptions& options) {
  keep_little_memory();
  studio::Server server(options.port);
  // Nothing to put away: the page keeps its scene by itself.
  std::signal(SIGINT, [](int) { _exit(0); });
  std::signal(SIGTERM, [](int) { _exit(0); });
  const std::string address = fmt::format("http://127.0.0.1:{}/", server.port());
  if (options.port != 0 && server.port() != options.port) {
    fmt::print("port {} is taken\n", options.port);
  }
  fmt::print("nuno studio: {}  (Ctrl-C ends it)\n", address);
  require_standard_output_written();
  if (options.opens_browser) open_browser(address);
  server.run();
}

}  // namespace nuno
