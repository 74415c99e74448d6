#include "text_file.h"

#include <nuno/output.h>
#include <nuno/scene.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace nuno {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // of UTF-8

int digit_of_base64(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

}  // namespace

std::string shown_text(std::string_view value, std::size_t most) {
  std::string text = printable(std::string(value.substr(0, most)));
  std::size_t end = std::min(most, text.size());  // what is no UTF-8 has become longer
  while (end < text.size() && (text[end] & '\xc0') == '\x80') --end;
  text.resize(end);
  return text;
}

std::size_t from_base64(std::string_view text, std::string& bytes) {
  const std::size_t padded = text.size();
  while (text.ends_with('=')) text.remove_suffix(1);
  bytes.reserve(bytes.size() + text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int digit = digit_of_base64(text[i]);
    if (digit < 0) return i;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<char>(bits >> count & 0xff));
    }
  }
  return padded;
}

void Line::refuse(std::string_view value, const std::string& rule) const {
  value.remove_prefix(std::min(value.find_first_not_of(" \t"), value.size()));
  throw InputError(fmt::format("{}:{}: {} {}", source, number, shown_text(value), rule));
}

std::string_view next_word(std::string_view& rest) {
  const std::size_t start = std::min(rest.find_first_not_of(line_blanks), rest.size());
  const std::size_t end = std::min(rest.find_first_of(line_blanks, start), rest.size());
  const std::string_view word = rest.substr(start, end - start);
  rest.remove_prefix(end);
  return word;
}

std::optional<double> number_in(std::string_view word) {
  std::string_view digits = word;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || word.starts_with("+-") || std::isnan(value))
    return {};
  if (error == std::errc::result_out_of_range) {
    return std::strtod(std::string(digits).c_str(), nullptr);  // 0 or infinity
  }
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

double number(std::string_view word, const Line& line) {
  const std::optional<double> found = number_in(word);
  if (!found) line.refuse(word, "is not a number");
  const double value = *found;
  if (!(std::abs(value) <= largest_scene_number)) {
    line.refuse(word, fmt::format("is not within ±{}", largest_scene_number));
  }
  return value;
}

void for_each_obj_line(const std::string& text, const std::string& source,
                       const std::function<void(std::string_view words, const Line& line)>& read) {
  Line line{source};
  std::string joined;  // of lines that end in a backslash
  Index next_line = 1;
  const auto read_statement = [&](std::string_view raw) {
    read(raw.substr(0, raw.find('#')), line);
  };
  for (std::size_t start = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
       start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string_view raw(text.data() + start, end - start);
    start = end + 1;
    if (joined.empty()) line.number = next_line;
    ++next_line;
    while (raw.ends_with('\r')) raw.remove_suffix(1);
    if (raw.ends_with('\\')) {
      raw.remove_suffix(1);
      joined.append(raw).append(" ");
      continue;
    }
    if (joined.empty()) {
      read_statement(raw);
    } else {
      read_statement(joined.append(raw));
      joined.clear();
    }
  }
  if (!joined.empty()) read_statement(joined);
}

Index obj_index(std::string_view text, std::string_view word, Index count, const char* of,
                const Line& line) {
  Index value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    line.refuse(word, "is not a corner: v, v/vt, v//vn or v/vt/vn");
  }
  const Index from_front = value > 0 ? value - 1 : count + value;
  if (value == 0 || from_front < 0 || from_front >= count) {
    line.refuse(word, fmt::format("names a {} that is not among the {} above", of, count));
  }
  return from_front;
}

}  // namespace nuno
