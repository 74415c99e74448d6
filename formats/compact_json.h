#pragma once

#include <nuno/points.h>

#include <cstddef>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>

namespace nuno {

/// What of a JSON document is kept, and how.
struct JsonForm {
  /// Where lists of points stand ("/initial"), and how many lists are around each of them.
  std::map<std::string_view, int> points = {};
  /// Names of the outermost object that are kept; empty: all.
  std::set<std::string_view> wanted = {};
  /// Lists in objects that are kept whole, and the most items of each.
  std::map<std::string_view, std::size_t> lists = {};
  /// Items that are kept of every other list that is none of points; of the rest nobody asks.
  std::size_t longest_list = std::numeric_limits<std::size_t>::max();
  /// Values in one another; far deeper ones could not even be shown without running out of stack.
  std::size_t deepest = 16;
  std::size_t most_values = std::numeric_limits<std::size_t>::max();  ///< kept or not
};

/// The JSON of `text` without a value for every number of its points: a list of them is a binary,
/// see points_of. Of an object's names the first 64 are kept: none that we read has so many. Throws
/// InputError for what is no JSON, nests deeply, has too many values or a name twice, a list of
/// points with anything else in it, or takes more memory than there is; `source` names the text.
nlohmann::ordered_json parse_compact(std::string_view text, const std::string& source,
                                     const JsonForm& form);

/// The points of a binary that parse_compact made [2 or 3 × any].
Points points_of(const nlohmann::ordered_json& value);

/// Points as JSON: a list of lists of numbers.
nlohmann::ordered_json json_of(const Points& points);

/// A value as a message shows it: on one line, cut where it is long.
std::string shown(const nlohmann::ordered_json& value);

/// The name of a field, which is the user's text, as part of a pointer in a message.
std::string shown_name(const std::string& name);

}  // namespace nuno
