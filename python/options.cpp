#include "options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace nuno::python {
namespace {

void require_word(const char* option, const std::string& word,
                  std::span<const std::string_view> words) {
  if (std::ranges::find(words, word) == words.end()) {
    throw InputError(
        fmt::format("{}: \"{}\" is not one of {}", option, word, fmt::join(words, ", ")));
  }
}

void require_finite(const char* option, double value) {
  if (!std::isfinite(value)) {
    throw InputError(fmt::format("{}: \"{}\" is not a finite number", option, value));
  }
}

}  // namespace

double non_negative(const char* option, double value) {
  require_finite(option, value);
  if (!(value >= 0)) throw InputError(fmt::format("{}: {} is not >= 0", option, value));
  return value;
}

double positive(const char* option, double value) {
  require_finite(option, value);
  if (!(value > 0)) throw InputError(fmt::format("{}: {} is not > 0", option, value));
  return value;
}

Index whole_number(const char* option, Index value, Index least, Index most) {
  if (value < least || value > most) {
    throw InputError(
        fmt::format("{}: {} is not a whole number within {} … {}", option, value, least, most));
  }
  return value;
}

void require_backend(const std::string& name) { require_word("--backend", name, backend_names); }

void require_right(const SearchOptions& options) {
  if (options.optimizer) require_word("--optimizer", *options.optimizer, optimizer_names);
  if (options.error_limit) non_negative("--error-limit", *options.error_limit);
  if (options.effort_limit) non_negative("--effort-limit", *options.effort_limit);
  whole_number("--coefficients", options.coefficients, 1, most_groups);
  require_compatible(options);
}

}  // namespace nuno::python
