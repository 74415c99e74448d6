#include <nuno/output.h>

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <unistd.h>

namespace nuno {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw OutputError(
      fmt::format("{}: cannot be written: {}", path == "-" ? "standard output" : path, why));
}

constexpr std::array ending_signals = {SIGINT, SIGTERM, SIGHUP};

/// The signals that end a program wait while this lives, so that none leaves a temporary file.
class SignalsHeld {
 public:
  SignalsHeld() {
    sigset_t held;
    sigemptyset(&held);
    for (const int signal : ending_signals) sigaddset(&held, signal);
    sigprocmask(SIG_BLOCK, &held, &before_);
  }
  ~SignalsHeld() { sigprocmask(SIG_SETMASK, &before_, nullptr); }
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_;
};

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

/// The file itself where `path` is a link to it: the link stays.
fs::path real_path(const std::string& path) {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(path, error);
  return error ? fs::path(path) : real;
}

constexpr const char* progress_start = "\r\x1b[K";  // of an emptied line

bool at_terminal() { return isatty(fileno(stderr)) != 0; }

}  // namespace

void require_writable(const std::string& path) {
  if (path.empty() || path == "-") return;
  std::error_code error;
  if (fs::is_directory(path, error)) refuse(path, std::strerror(EISDIR));
  if (is_device(path)) return;
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
    const SignalsHeld held;
    TemporaryFile file(path, real_path(path));
    write(file.get());
    file.take_place();
  }
} catch (const std::system_error& error) {  // fmt::print's, where a disk is full
  refuse(path, error.code().message());
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
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  }
  return text;
}

// A standard error that takes nothing is no reason to stop: fputs and not fmt::print, which throws.

void complain(const std::string& message) {
  clear_progress();
  std::fputs((printable(message) + '\n').c_str(), stderr);
}

void show_progress(const std::string& text) {
  if (at_terminal()) std::fputs((progress_start + printable(text)).c_str(), stderr);
}

void clear_progress() {
  if (at_terminal()) std::fputs(progress_start, stderr);
}

}  // namespace nuno
