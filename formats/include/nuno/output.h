#pragma once

#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

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

/// Throws OutputError if `path` cannot be written, before the work that it shall hold is done.
/// Leaves what is there as it is.
void require_writable(const std::string& path);

/// Has `write` write a file that then takes the place of `path`, whole or not at all: whatever
/// fails or interrupts leaves what was there. "-" is standard output.
void write_output(const std::string& path, const std::function<void(std::FILE*)>& write);

/// Throws OutputError if a signal that ends the program came since a file began to be written: it
/// waits until nothing of the file is left.
void stop_where_ended();

/// Makes the folder `path` and those above it, if they are not there. Throws OutputError.
void create_folder(const std::string& path);

/// Throws OutputError if anything that was printed to standard output got lost.
void require_standard_output_written();

/// Where summaries and tables for people go: not where the JSON of `out` goes.
std::FILE* people(const std::string& out);

/// A text of a user's on one line and without codes that a terminal would obey.
std::string printable(std::string text);

/// Says on standard error, on one line, what went wrong.
void complain(const std::string& message);

/// Tells a person at a terminal how far the work is, on a line that the next call replaces.
/// Silent where standard error is no terminal.
void show_progress(const std::string& text);
void clear_progress();

}  // namespace nuno
