#include <nuno/input.h>
#include <nuno/scene.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

#include <sys/stat.h>

#include <nuno/output.h>

namespace nuno {

std::string name_of_input(const std::string& path) { return path == "-" ? "standard input" : path; }

std::string read_file(const std::string& path, const std::string& at, const char* what,
                      std::size_t most) {
  const auto refuse = [&](const std::string& fault) {
    throw InputError(fmt::format("{}: {}", at, fault));
  };
  const File opened(path == "-" ? nullptr : std::fopen(path.c_str(), "rb"));
  std::FILE* const file = path == "-" ? stdin : opened.get();
  if (!file) refuse(fmt::format("cannot be opened for reading: {}", std::strerror(errno)));
  struct stat status {};
  const bool is_known = fstat(fileno(file), &status) == 0;
  if (is_known && S_ISDIR(status.st_mode)) refuse(fmt::format("is a directory, not {}", what));
  std::string text;
  try {
    // In one piece where the size is known: growing takes up to three times as much.
    std::size_t part = 1 << 16;
    if (is_known && S_ISREG(status.st_mode)) part += static_cast<std::size_t>(status.st_size);
    std::size_t size = 0;
    do {
      text.resize(size + part);
      const std::size_t got = std::fread(text.data() + size, 1, part, file);
      size += got;
      if (size > most) refuse(fmt::format("is larger than {} MiB", most >> 20));
      if (got < part) break;
      part = size / 2;
    } while (true);
    text.resize(size);
  } catch (const std::bad_alloc&) {
    refuse("needs more memory than there is");
  }
  if (std::ferror(file)) refuse(fmt::format("cannot be read: {}", std::strerror(errno)));
  return text;
}

std::string read_input(const std::string& path) {
  return read_file(path, name_of_input(path), "a file of JSON");
}

}  // namespace nuno
