#pragma once

#include <nuno/scene.h>

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace nuno {

/// A value as a message shows it: on one line, cut where it is long.
template <typename Json>
std::string shown(const Json& value) {
  if (value.is_structured() && value.size() > 20) {
    return fmt::format("{} of {} values", value.type_name(), value.size());
  }
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

/// A place in a JSON file, for messages.
struct Field {
  const std::string& source;
  std::string pointer;

  Field child(std::string_view name) const { return {source, fmt::format("{}/{}", pointer, name)}; }
  Field child(std::size_t number) const { return {source, fmt::format("{}/{}", pointer, number)}; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}: {}: {}", source, pointer.empty() ? "/" : pointer, what));
  }
};

}  // namespace nuno
