#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <nuno/output.h>

namespace nuno {

/// A program that we use is missing or has failed; the message says which, and what to type.
class ExternalError : public OutputError {
 public:
  using OutputError::OutputError;
};

/// Throws ExternalError if `program` is not on the path; `package` is Debian's that has it.
void require_program(const std::string& program, const std::string& package,
                     const std::string& purpose);

/// Takes text for the standard input of a program.
using Feed = std::function<void(std::string_view)>;

/// Runs a program whose standard input is what `write` feeds it and whose output goes to `out`, and
/// calls `wait` several times a second while it has to wait for it. Throws ExternalError with the
/// last thing it said if it fails; what `write` and `wait` throw kills it.
void run_program(
    const std::vector<std::string>& arguments, const std::function<void(const Feed&)>& write,
    std::FILE* out, const std::function<void()>& wait = [] {});

inline constexpr double png_scale = 2;

/// Throws ExternalError where SVG cannot be made into PNG.
void require_png();

/// An SVG file as PNG, at png_scale.
void write_png(const std::string& svg, std::FILE* out);

}  // namespace nuno
