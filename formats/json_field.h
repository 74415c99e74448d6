#pragma once

#include <nuno/scene.h>

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace nuno {

/// A place in a JSON file, for messages.
struct Field {
  const std::string& source;
  std::string pointer;

  Field child(std::string_view name) const { return {source, fmt::format("{}/{}", pointer, name)}; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}: {}: {}", source, pointer.empty() ? "/" : pointer, what));
  }
};

}  // namespace nuno
