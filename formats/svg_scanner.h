#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "svg_values.h"

namespace nuno {

/// Reads the numbers of a value from left to right. They need a separator only where they would run
/// together without: "1.5.5-2" are three.
class SvgScanner {
 public:
  explicit SvgScanner(const SvgValue& value) : value_(value) {}

  void skip_blanks();
  bool at_end() const { return at_ == value_.text.size(); }
  char peek() const { return at_end() ? '\0' : value_.text[at_]; }
  char take() { return value_.text[at_++]; }
  /// Whether the next character is this one, which is taken.
  bool take(char wanted);
  /// The letters from here on.
  std::string_view take_word();

  double number();
  bool flag();
  /// Blanks, of which one may be a comma.
  void separator();
  /// Whether a number follows, after a separator.
  bool has_more();

  /// Throws InputError, with the place of the character reached.
  [[noreturn]] void refuse(const std::string& rule) const;

 private:
  bool at_number() const;

  const SvgValue& value_;
  std::size_t at_ = 0;
};

}  // namespace nuno
