#pragma once

#include <cstddef>
#include <limits>
#include <string>

namespace nuno {

/// What messages call the file at `path`, which is standard input where that is "-".
std::string name_of_input(const std::string& path);

/// Everything that is in the file at `path`, a pipe too; "-" is standard input. Throws InputError,
/// which begins with `at`, where it cannot be read, or holds more than `most` bytes; `what` says
/// what it should hold: "a mesh".
std::string read_file(const std::string& path, const std::string& at, const char* what,
                      std::size_t most = std::numeric_limits<std::size_t>::max());

/// The same of a file of JSON; messages begin with its name.
std::string read_input(const std::string& path);

}  // namespace nuno
