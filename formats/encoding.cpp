#include "encoding.h"

#include <nuno/scene.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace nuno {
namespace {

using namespace std::string_view_literals;

// How files of kinds that are taken for text by mistake begin.
constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kinds = {{
    {"\x1f\x8b"sv, "gzip: unpack it"},
    {"PK\x03\x04"sv, "a zip archive: unpack it"},
    {"\x89PNG"sv, "a PNG picture"},
    {"\xff\xd8\xff"sv, "a JPEG picture"},
    {"%PDF"sv, "a PDF"},
    {"glTF"sv, "binary glTF: a mesh, whose name ends in .glb"},
    {"BLENDER"sv, "a file of Blender's own: export from it"},
}};

bool is_utf16(std::string_view text) {
  if (text.starts_with("\xff\xfe"sv) || text.starts_with("\xfe\xff"sv)) return true;
  // Plain letters in it have a zero byte each, always on the same side.
  const auto zeros = [&](std::size_t from) {
    std::size_t count = 0;
    for (std::size_t i = from; i < std::min<std::size_t>(text.size(), 64); i += 2) {
      if (text[i] == '\0') ++count;
    }
    return count;
  };
  const std::size_t pairs = std::min<std::size_t>(text.size(), 64) / 2;
  const std::size_t even = zeros(0), odd = zeros(1);
  return pairs > 1 && ((even == 0 && 2 * odd > pairs) || (odd == 0 && 2 * even > pairs));
}

}  // namespace

/// Bytes of the character that `text`, which is not empty, begins with; 0 where that is no UTF-8 or
/// no character of XML.
std::size_t character_length(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char byte = at(0);
  const std::size_t length = byte < 0x80   ? 1
                             : byte < 0xc2 ? 0
                             : byte < 0xe0 ? 2
                             : byte < 0xf0 ? 3
                             : byte < 0xf5 ? 4
                                           : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((at(k) & 0xc0) != 0x80) return 0;
  }
  // Overlong forms, surrogates, and code points that XML forbids.
  if (length == 3 && ((byte == 0xe0 && at(1) < 0xa0) || (byte == 0xed && at(1) > 0x9f) ||
                      (byte == 0xef && at(1) == 0xbf && at(2) > 0xbd))) {
    return 0;
  }
  if (length == 4 && ((byte == 0xf0 && at(1) < 0x90) || (byte == 0xf4 && at(1) > 0x8f))) return 0;
  return length;
}

std::string encoding_fault(std::string_view text) {
  if (is_utf16(text)) return "it is UTF-16: save it as UTF-8";
  for (const auto& [start, kind] : kinds) {
    if (text.starts_with(start)) return fmt::format("it is {}", kind);
  }
  if (text.find('\0') != std::string_view::npos) return "it is a binary file";
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character_length(text.substr(i));
    if (length == 0) {
      return fmt::format(
          "byte 0x{:02X} in line {} is no UTF-8: is it Latin-1? Save it as UTF-8",
          static_cast<unsigned char>(text[i]),
          1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(i), '\n'));
    }
    i += length;
  }
  return {};
}

void require_text(std::string_view text, const std::string& source) {
  if (text.find('\0') == std::string_view::npos) return;
  throw InputError(fmt::format("{}: is no text: {}", source, encoding_fault(text)));
}

}  // namespace nuno
