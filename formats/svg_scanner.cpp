#include "svg_scanner.h"

#include <nuno/scene.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "text_file.h"

namespace nuno {
namespace {

constexpr std::string_view blanks = " \t\r\n\f";

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

}  // namespace

void SvgScanner::skip_blanks() {
  at_ = std::min(value_.text.find_first_not_of(blanks, at_), value_.text.size());
}

bool SvgScanner::take(char wanted) {
  if (peek() != wanted || at_end()) return false;
  ++at_;
  return true;
}

std::string_view SvgScanner::take_word() {
  const std::size_t start = at_;
  while (is_letter(peek())) ++at_;
  return value_.text.substr(start, at_ - start);
}

double SvgScanner::number() {
  const std::string_view rest = value_.text.substr(at_);
  if (!at_number()) refuse(rest.empty() ? "ends where a number is due" : "is not a number");
  const std::size_t plus = rest.starts_with('+') ? 1 : 0;
  double value = 0;
  const char* const end = rest.data() + rest.size();
  const auto [stop, error] = std::from_chars(rest.data() + plus, end, value);
  const std::string_view digits = rest.substr(0, static_cast<std::size_t>(stop - rest.data()));
  if (error == std::errc::result_out_of_range && digits.find("e-") == std::string_view::npos &&
      digits.find("E-") == std::string_view::npos) {
    value = HUGE_VAL;
  }
  if (!(std::abs(value) <= largest_scene_number)) {
    refuse(fmt::format("is not within ±{}", largest_scene_number));
  }
  at_ += digits.size();
  return value;
}

bool SvgScanner::at_number() const {
  std::string_view rest = value_.text.substr(at_);
  if (rest.starts_with('+') || rest.starts_with('-')) rest.remove_prefix(1);
  if (rest.starts_with('.')) rest.remove_prefix(1);
  return !rest.empty() && is_digit(rest.front());
}

bool SvgScanner::flag() {
  if (peek() != '0' && peek() != '1') refuse("is not a flag of an arc, 0 or 1");
  return take() == '1';
}

void SvgScanner::separator() {
  skip_blanks();
  if (take(',')) skip_blanks();
}

bool SvgScanner::has_more() {
  skip_blanks();
  if (take(',')) {
    skip_blanks();
    if (!at_number()) refuse("is not a number");
  }
  return at_number() || peek() == '+' || peek() == '-' || peek() == '.';
}

void SvgScanner::refuse(const std::string& rule) const {
  const std::string_view rest = value_.text.substr(at_);
  SvgValue place = value_;
  place.text = rest.empty() ? value_.text : rest.substr(0, 20);
  place.refuse(fmt::format("at character {} {}", at_ + 1, rule));
}

}  // namespace nuno
