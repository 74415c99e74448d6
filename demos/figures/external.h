#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "../output.h"

namespace nuno {

/// A program that we use is missing or has failed; the message says which, and what to type.
class ExternalError : public OutputError {
 public:
  using OutputError::OutputError;
};

/// Throws ExternalError if `program` is not on the path; `package` is Debian's that has it.
void require_program(const std::string& program, const std::string& package,
                     const std::string& purpose);

/// Runs a program whose standard input is what `write` writes and whose output goes to `out`.
/// Throws ExternalError with the last thing it said if it fails.
void run_program(const std::vector<std::string>& arguments,
                 const std::function<void(std::FILE*)>& write, std::FILE* out);

inline constexpr double png_scale = 2;

/// Throws ExternalError where SVG cannot be made into PNG.
void require_png();

/// An SVG file as PNG, at png_scale.
void write_png(const std::string& svg, std::FILE* out);

}  // namespace nuno
