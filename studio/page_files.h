#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nuno::studio {

/// A file of the page.
struct PageFile {
  std::string_view path, type, text;
};

/// The one that the page asks for under `path`, if there is one.
std::optional<PageFile> page_file(std::string_view path);

/// The scenes of the gallery; the page has their files under /scenes/.
std::vector<std::string> demo_names();

}  // namespace nuno::studio
