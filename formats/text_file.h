#pragma once

#include <nuno/points.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

// What the readers of text files share.

namespace nuno {

inline constexpr std::size_t largest_file = 256 << 20;  ///< bytes: millions of vertices

/// A place of a file, for messages.
struct Line {
  const std::string& source;
  Index number = 0;

  /// Throws InputError.
  [[noreturn]] void refuse(std::string_view value, const std::string& rule) const;
};

/// A value as a message shows it: on one line, of at most `most` bytes, cut between two characters.
std::string shown_text(std::string_view value, std::size_t most = 60);

/// Appends the bytes of a text in base64, and returns where it is none any more: its size if all
/// is.
std::size_t from_base64(std::string_view text, std::string& bytes);

inline constexpr std::string_view line_blanks = " \t\r\v\f";

/// Cuts the next word off `rest`; empty at its end.
std::string_view next_word(std::string_view& rest);

/// The number that is the whole word; infinite or 0 where it is beyond doubles, none where it is no
/// number.
std::optional<double> number_in(std::string_view word);

/// The same within those of a scene. Throws InputError.
double number(std::string_view word, const Line& line);

/// The statements of a Wavefront OBJ text: without comments, joined where a line ends in a
/// backslash.
void for_each_obj_line(const std::string& text, const std::string& source,
                       const std::function<void(std::string_view words, const Line& line)>& read);

/// An index of an OBJ file, from 1 on or from the back, as one from 0 on; `word` is the corner that
/// it is part of, `of` names what it counts.
Index obj_index(std::string_view text, std::string_view word, Index count, const char* of,
                const Line& line);

}  // namespace nuno
