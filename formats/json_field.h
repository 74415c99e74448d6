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

/// Looks through a JSON text before it is kept; an InputError for what is beyond the limits or
/// names a field of an object twice. Ends at what is no JSON, in the words of the parser proper.
template <typename Json>
class JsonInspector : public nlohmann::json_sax<Json> {
 public:
  using Sax = nlohmann::json_sax<Json>;

  JsonInspector(const Field& root, const JsonLimits& limits) : root_(root), limits_(limits) {}

  bool null() override { return count(); }
  bool boolean(bool /*value*/) override { return count(); }
  bool number_integer(typename Sax::number_integer_t /*value*/) override { return count(); }
  bool number_unsigned(typename Sax::number_unsigned_t /*value*/) override { return count(); }
  bool number_float(typename Sax::number_float_t /*value*/,
                    const typename Sax::string_t& /*text*/) override {
    return count();
  }
  bool string(typename Sax::string_t& /*value*/) override { return count(); }
  bool binary(typename Sax::binary_t& /*value*/) override { return count(); }
  bool start_object(std::size_t /*size*/) override { return enter(); }
  bool end_object() override { return leave(); }
  bool start_array(std::size_t /*size*/) override { return enter(); }
  bool end_array() override { return leave(); }
  bool key(typename Sax::string_t& name) override {
    if (!names_.back().insert(name).second) {
      root_.refuse(fmt::format("{} stands twice in one object", shown(Json(name))));
    }
    return count();
  }
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& /*error*/) override {
    return false;
  }

 private:
  bool count() {
    if (++values_ > limits_.most_values) {
      root_.refuse(
          fmt::format("not {}: has more than {} values", limits_.kind, limits_.most_values));
    }
    return true;
  }
  bool enter() {
    names_.emplace_back();
    if (std::ssize(names_) > limits_.depth) {
      root_.refuse(fmt::format("not {}: nested more than {} deep", limits_.kind, limits_.depth));
    }
    return count();
  }
  bool leave() {
    names_.pop_back();
    return true;
  }

  const Field& root_;
  const JsonLimits& limits_;
  std::vector<std::set<std::string>> names_;  // of the objects around, none of an array
  std::size_t values_ = 0;
};

/// The JSON of `text`; an InputError for what is no JSON, goes beyond the limits, or names a field
/// of an object twice.
template <typename Json>
Json parse_json(std::string_view text, const std::string& source, const JsonLimits& limits) {
  const Field root{source, ""};
  JsonInspector<Json> inspector(root, limits);
  Json::sax_parse(text, &inspector);
  try {
    return Json::parse(text);
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
