#pragma once

#include <cstdint>
#include <string>

namespace nuno {

/// The whole of a file that a mesh is read from. Throws InputError that begins with `name` where it
/// cannot be read or is larger than `most` bytes.
std::string file_text(const std::string& path, const std::string& name, std::uintmax_t most);

}  // namespace nuno
