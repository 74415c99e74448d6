#pragma once

#include <cstddef>
#include <string>
#include <string_view>

// What bytes are as text.

namespace nuno {

/// Bytes of the character that `text`, which is not empty, begins with; 0 where that is no UTF-8 or
/// no character of XML.
std::size_t character_length(std::string_view text);

/// What a file seems to be that is no text in UTF-8, and what to do, for messages; empty where it
/// is one.
std::string encoding_fault(std::string_view text);

/// Throws InputError for a file with bytes that no text has; `source` names it.
void require_text(std::string_view text, const std::string& source);

}  // namespace nuno
