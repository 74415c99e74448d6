#pragma once

#include <string>

namespace nuno {

/// What messages call the file at `path`, which is standard input where that is "-".
std::string name_of_input(const std::string& path);

/// Everything that is in the file at `path`, a pipe too; "-" is standard input. Throws InputError.
std::string read_input(const std::string& path);

}  // namespace nuno
