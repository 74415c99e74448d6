#pragma once

#include <nuno/scene.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace nuno {

/// A value as a message shows it: on one line, cut where it is long.
template <typename Json>
std::string shown(const Json& value) {
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

/// A place in a JSON file, for messages.
struct Field {
  const std::string& source;
  std::string pointer;

  Field child(std::string_view name) const { return {source, fmt::format("{}/{}", pointer, name)}; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}: {}: {}", source, pointer.empty() ? "/" : pointer, what));
  }
};

/// What a kind of JSON file may be, so that it can be read within memory and shown within the
/// stack.
struct JsonLimits {
  const char* kind;         ///< for messages: "a scene"
  int depth;                ///< of values in one another
  std::size_t most_values;  ///< names included
};

/// The JSON of `text`; an InputError for what is no JSON, goes beyond the limits, or names a field
/// of an object twice.
template <typename Json>
Json parse_json(std::string_view text, const std::string& source, const JsonLimits& limits) {
  const Field root{source, ""};
  std::vector<std::set<std::string>> names;
  std::size_t values = 0;
  const auto watch = [&](int depth, typename Json::parse_event_t event, Json& value) {
    using Event = typename Json::parse_event_t;
    if (depth > limits.depth) {
      root.refuse(fmt::format("not {}: nested more than {} deep", limits.kind, limits.depth));
    }
    if (++values > limits.most_values) {
      root.refuse(fmt::format("not {}: has more than {} values", limits.kind, limits.most_values));
    }
    if (event == Event::object_start) {
      names.emplace_back();
    } else if (event == Event::object_end) {
      names.pop_back();
    } else if (event == Event::key &&
               !names.back().insert(value.template get<std::string>()).second) {
      root.refuse(fmt::format("{} stands twice in one object", shown(value)));
    }
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const typename Json::exception& error) {
    std::string what = error.what();  // "[json.exception.…] message", possibly over several lines
    if (const auto end = what.find("] "); end != std::string::npos) what = what.substr(end + 2);
    if (what.size() > 300) what = what.substr(0, 297) + "...";
    std::ranges::replace_if(
        what, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    root.refuse("not JSON: " + what);
  }
}

}  // namespace nuno
