#include <nuno/output.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>

#include <unistd.h>

#include "encoding.h"
#include "progress_pace.h"

namespace nuno {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw OutputError(
      fmt::format("{}: cannot be written: {}", path == "-" ? "standard output" : path, why));
}

constexpr std::array ending_signals = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU};

/// Of the signals that would end the program with a dump of its memory and no word.
extern "C" void say_and_end(int signal) {
  const std::string_view word = signal == SIGXCPU
                                    ? "nuno: the processor time that is allowed has run out\n"
                                    : "nuno: interrupted\n";
  [[maybe_unused]] const ssize_t said = ::write(STDERR_FILENO, word.data(), word.size());
  _exit(1);
}

/// A new file beside `target`, gone with this object unless it has taken the target's place.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& shown, const fs::path& target) : shown_(shown), target_(target) {
    for (int i = 0; !file_; ++i) {
      path_ = target.parent_path() / fmt::format(".nuno-{}-{}.tmp", getpid(), i);
      file_.reset(std::fopen(path_.c_str(), "wx"));  // x: never a file that is there already
      if (!file_ && errno != EEXIST) refuse(shown_, std::strerror(errno));
    }
  }
  ~TemporaryFile() {
    if (!path_.empty()) std::remove(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  std::FILE* get() { return file_.get(); }

  void take_place() {
    // On the disk before it is in place, or a power cut could leave the name with half a file.
    if (std::fflush(get()) != 0 || std::ferror(get()) || fsync(fileno(get())) != 0) {
      refuse(shown_, std::strerror(errno));
    }
    if (std::fclose(file_.release()) != 0) refuse(shown_, std::strerror(errno));
    std::error_code error;
    const fs::file_status replaced = fs::status(target_, error);
    if (fs::exists(replaced)) fs::permissions(path_, replaced.permissions(), error);
    fs::rename(path_, target_, error);
    if (error) refuse(shown_, error.message());
    path_.clear();
  }

 private:
  std::string shown_;
  fs::path target_;
  fs::path path_;
  File file_;
};

/// Whether a rename would replace something that is no file, as /dev/null or a pipe.
bool is_device(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_regular_file(status);
}

/// The file itself where `path` is a link to it, there or not yet: the link stays.
fs::path real_path(const std::string& path) {
  constexpr int most_links = 40;  // as the system has it
  fs::path real = path;
  std::error_code error;
  for (int i = 0; fs::is_symlink(fs::symlink_status(real, error)); ++i) {
    if (i == most_links) refuse(path, std::strerror(ELOOP));
    real = real.parent_path() / fs::read_symlink(real, error);
    if (error) refuse(path, error.message());
  }
  return real;
}

/// Throws for a file that may not be written: a rename would replace it all the same.
void require_permission(const std::string& path) {
  if (access(path.c_str(), F_OK) == 0 && access(path.c_str(), W_OK) != 0) {
    refuse(path, std::strerror(errno));
  }
}

constexpr const char* progress_start = "\r\x1b[K";  // of an emptied line

ProgressPace pace;

bool at_terminal() { return isatty(fileno(stderr)) != 0; }

}  // namespace

void handle_signals() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGQUIT, say_and_end);
  std::signal(SIGXCPU, say_and_end);
}

SignalsHeld::SignalsHeld() {
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : ending_signals) sigaddset(&held, signal);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
}

SignalsHeld::~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

void require_writable(const std::string& path) {
  if (path.empty() || path == "-") return;
  std::error_code error;
  if (fs::is_directory(path, error)) refuse(path, std::strerror(EISDIR));
  if (is_device(path)) return;
  require_permission(path);
  const SignalsHeld held;
  const TemporaryFile trial(path, real_path(path));
}

void write_output(const std::string& path, const std::function<void(std::FILE*)>& write) try {
  if (path == "-") {
    write(stdout);
    require_standard_output_written();
  } else if (is_device(path)) {
    const File file(std::fopen(path.c_str(), "w"));
    if (!file) refuse(path, std::strerror(errno));
    write(file.get());
    if (std::fflush(file.get()) != 0 || std::ferror(file.get())) refuse(path, std::strerror(errno));
  } else {
    require_permission(path);
    const SignalsHeld held;
    TemporaryFile file(path, real_path(path));
    write(file.get());
    file.take_place();
  }
} catch (const std::system_error& error) {  // fmt::print's, where a disk is full
  refuse(path, error.code().message());
}

void write_output(const std::string& path, std::string_view text) {
  // What it cannot write, the file remembers.
  write_output(path, [&](std::FILE* file) { std::fwrite(text.data(), 1, text.size(), file); });
}

std::string written_text(const std::function<void(std::FILE*)>& write) {
  char* text = nullptr;  // the file's own until it is closed
  std::size_t size = 0;
  const auto release = [&text](std::FILE* file) {
    std::fclose(file);
    std::free(text);
  };
  const std::unique_ptr<std::FILE, decltype(release)> file(open_memstream(&text, &size), release);
  if (!file) throw std::bad_alloc();
  write(file.get());
  if (std::fflush(file.get()) != 0 || std::ferror(file.get())) throw std::bad_alloc();
  return {text, size};
}

void stop_where_ended() {
  sigset_t waiting;
  sigpending(&waiting);
  for (const int signal : ending_signals) {
    if (sigismember(&waiting, signal) == 1) throw OutputError("interrupted");
  }
}

void create_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path, error)) {
    throw OutputError(fmt::format("{}: is not a folder that can be created: {}", path,
                                  error ? error.message() : "something else has that name"));
  }
}

void require_standard_output_written() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout)) {
    refuse("-", std::strerror(errno));
  }
}

std::FILE* people(const std::string& out) { return out == "-" ? stderr : stdout; }

std::string printable(std::string text) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character_length(std::string_view(text).substr(i));
    const auto byte = static_cast<unsigned char>(text[i]);
    if (length == 0) {
      result += "\xef\xbf\xbd";
    } else if (byte < ' ' || byte == 0x7f) {
      result += ' ';
    } else {
      result.append(text, i, length);
    }
    i += std::max<std::size_t>(length, 1);
  }
  return result;
}

std::string message_for_people(const std::string& message) {
  constexpr std::size_t most = 400, start = 250;
  std::string text = printable(message);
  if (text.size() <= most) return text;
  std::size_t cut = start, rest = text.size() - (most - start - 5);
  const auto is_inside = [&](std::size_t i) { return (text[i] & '\xc0') == '\x80'; };
  while (is_inside(cut)) --cut;
  while (rest < text.size() && is_inside(rest)) ++rest;
  return text.substr(0, cut) + " … " + text.substr(rest);
}

// A standard error that takes nothing is no reason to stop: fputs and not fmt::print, which throws.

void complain(const std::string& message) {
  clear_progress();
  std::fputs((message_for_people(message) + '\n').c_str(), stderr);
}

void note(const std::string& message) { complain(message); }

void show_progress(const std::string& text) {
  if (at_terminal()) {
    std::fputs((progress_start + printable(text)).c_str(), stderr);
    return;
  }
  if (pace.is_due(std::chrono::steady_clock::now())) {
    std::fputs((printable(text) + '\n').c_str(), stderr);
  }
}

void clear_progress() {
  pace.end();
  if (at_terminal()) std::fputs(progress_start, stderr);
}

}  // namespace nuno
