#pragma once

#include <csignal>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace nuno {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
/// An open file, closed with this object.
using File = std::unique_ptr<std::FILE, CloseFile>;

/// An output cannot be written; the message names it and says why.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// For a program's first line: a reader that leaves early and a file that may not grow are outputs
/// that cannot be written, not a silent death; and of the signals that end a program, none does so
/// without a word or, see write_output, with half a file.
void handle_signals();

/// The signals that end a program wait while this lives, for this thread and those that it starts
/// meanwhile, which hold them for good: so none ends the program while another thread writes a
/// file.
class SignalsHeld {
 public:
  SignalsHeld();
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_;
};

/// Throws OutputError if `path` cannot be written, before the work that it shall hold is done.
/// Leaves what is there as it is.
void require_writable(const std::string& path);

/// Has `write` write a file that then takes the place of `path`, whole or not at all: whatever
/// fails or interrupts leaves what was there. "-" is standard output.
void write_output(const std::string& path, const std::function<void(std::FILE*)>& write);
void write_output(const std::string& path, std::string_view text);

/// What `write` writes, as text. Throws std::bad_alloc where it has no room.
std::string written_text(const std::function<void(std::FILE*)>& write);

/// Throws OutputError if a signal that ends the program came since a file began to be written: it
/// waits until nothing of the file is left.
void stop_where_ended();

/// Makes the folder `path` and those above it, if they are not there. Throws OutputError.
void create_folder(const std::string& path);

/// Throws OutputError if anything that was printed to standard output got lost.
void require_standard_output_written();

/// Where summaries and tables for people go: not where the JSON of `out` goes.
std::FILE* people(const std::string& out);

/// A text of a user's on one line, in valid UTF-8 and without codes that a terminal would obey.
std::string printable(std::string text);

/// A message as a person reads it: printable, and of at most 400 bytes; a longer one loses its
/// middle.
std::string message_for_people(const std::string& message);

/// Says on standard error, on one line, what went wrong.
void complain(const std::string& message);

/// Says on standard error, on one line, what a person wants to know meanwhile.
void note(const std::string& message);

/// Tells a person how far the work is: at a terminal on a line that the next call replaces, else,
/// of work that takes long, on a line every half minute.
void show_progress(const std::string& text);
void clear_progress();

}  // namespace nuno
