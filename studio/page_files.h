#pragma once

#include <optional>
#include <string_view>

namespace nuno::studio {

/// A file of the page.
struct PageFile {
  std::string_view path, type, text;
};

/// The one that the page asks for under `path`, if there is one.
std::optional<PageFile> page_file(std::string_view path);

}  // namespace nuno::studio
