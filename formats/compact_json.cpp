#include "compact_json.h"

#include <nuno/output.h>
#include <nuno/scene.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "encoding.h"
#include "text_file.h"

namespace nuno {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_names = 64;
constexpr std::size_t most_rows = 3;  // coordinates of a point

/// Takes a document's parts from nlohmann's parser as they come, and keeps those that are wanted.
class Reader {
 public:
  Reader(std::string_view text, std::string source, const JsonForm& form)
      : text_(text), source_(std::move(source)), form_(form) {}

  Json take() { return std::move(root_); }

  // What the parser calls; false would end it.
  bool null() { return scalar(nullptr); }
  bool boolean(bool value) { return scalar(value); }
  bool number_integer(Json::number_integer_t value) { return scalar(value); }
  bool number_unsigned(Json::number_unsigned_t value) { return scalar(value); }
  bool number_float(double value, const std::string& text) {
    if (value == 0 && !skips() && text.find_first_of("123456789") < text.find_first_of("eE")) {
      throw InputError(fmt::format("{}: {}: {} is nearer to 0 than numbers can be", source_,
                                   place(levels_.size()), shown_text(text)));
    }
    return scalar(value);
  }
  bool string(std::string& value) { return scalar(std::move(value)); }
  bool binary(Json::binary_t&) { return true; }  // JSON has none

  bool start_object(std::size_t) {
    if (skips()) return begin(Kind::object);
    if (!levels_.empty() && is_of_points(levels_.back())) put(Json::object());
    return begin(Kind::object);
  }
  bool key(std::string& name) {
    if (skipped_ > 0) return true;
    Level& top = levels_.back();
    top.name = std::move(name);
    const bool is_wanted = levels_.size() > 1 || form_.wanted.empty() ||
                           form_.wanted.contains(std::string_view(top.name));
    top.is_dropped = !is_wanted || top.value.size() >= most_names;
    if (!top.is_dropped && top.value.contains(top.name)) {
      throw InputError(
          fmt::format("{}: {}: stands twice in one object", source_, place(levels_.size())));
    }
    return true;
  }
  bool end_object() { return end(); }

  bool start_array(std::size_t) {
    if (skips()) return begin(Kind::list);
    const int around = lists_around_points();
    if (!levels_.empty() && levels_.back().kind == Kind::point) put(Json::array());
    if (!levels_.empty() && levels_.back().kind == Kind::points) return begin(Kind::point);
    const std::size_t longest = longest_list();
    begin(around == 0 ? Kind::points : Kind::list);
    levels_.back().around = around - 1;
    levels_.back().longest = longest;
    return true;
  }
  bool end_array() { return end(); }

  bool parse_error(std::size_t, const std::string&, const Json::exception& error) {
    const std::string fault = encoding_fault(text_);
    if (!fault.empty()) throw InputError(fmt::format("{}: /: not JSON: {}", source_, fault));
    std::string what = error.what();  // "[json.exception.…] message", possibly over several lines
    if (const auto end = what.find("] "); end != std::string::npos) what = what.substr(end + 2);
    // What it read last may be as long as the file.
    for (const std::string_view before : {"last read: '", "number overflow parsing '"}) {
      const auto found = what.find(before);
      if (found == std::string::npos) continue;
      const auto start = found + before.size(), end = what.rfind('\'');
      if (end > start + 60) what.replace(start + 30, end - start - 60, "...");
    }
    throw InputError(fmt::format("{}: /: not JSON: {}", source_, printable(what)));
  }

 private:
  enum class Kind { object, list, points, point };
  // To clang-tidy, moving nlohmann's JSON may throw.
  // NOLINTNEXTLINE(bugprone-exception-escape)
  struct Level {
    Kind kind = Kind::list;
    Json value = {};          ///< of an object or a list; of a point, what a message shows of it
    std::string name = {};    ///< in an object, of the value that comes
    bool is_dropped = false;  ///< that value
    std::size_t index = 0;    ///< in a list, of the value that comes
    std::size_t longest = 0;  ///< a list that is kept whole may be; 0 of any other
    int around = -1;          ///< lists around the points that are in this list, which excludes it
    std::size_t rows = 0;     ///< of all points
    std::array<double, most_rows> point = {};
    std::vector<std::uint8_t> points = {};
  };
  static bool is_of_points(const Level& level) {
    return level.kind == Kind::points || level.kind == Kind::point;
  }

  /// Whether nobody asks for the value that comes.
  bool skips() const {
    if (skipped_ > 0) return true;
    if (levels_.empty()) return false;
    const Level& top = levels_.back();
    return top.kind == Kind::object ? top.is_dropped
                                    : top.kind == Kind::list && top.around < 0 &&
                                          top.longest == 0 && top.index >= form_.longest_list;
  }

  /// Of the list that comes, if it is to be kept whole; else 0.
  std::size_t longest_list() const {
    if (form_.lists.empty() || levels_.empty() || levels_.back().kind != Kind::object) return 0;
    const auto found = form_.lists.find(std::string_view(pointer()));
    return found == form_.lists.end() ? 0 : found->second;
  }

  /// Of the list that comes: how many lists are around its points; negative where it has none.
  int lists_around_points() const {
    if (levels_.empty()) return -1;
    if (levels_.back().kind == Kind::list) return levels_.back().around;
    const auto found = form_.points.find(std::string_view(pointer()));
    return found == form_.points.end() ? -1 : found->second;
  }

  bool scalar(Json value) {
    count();
    return put(std::move(value));
  }

  /// Counts a value, kept or not.
  void count() {
    if (++values_ > form_.most_values) {
      throw InputError(fmt::format("{}: /: has more than {} values", source_, form_.most_values));
    }
  }

  bool begin(Kind kind) {
    count();
    if (levels_.size() + skipped_ >= form_.deepest) {
      throw InputError(fmt::format("{}: /: nested more than {} deep", source_, form_.deepest));
    }
    if (skips()) {
      ++skipped_;
      return true;
    }
    Level& level = levels_.emplace_back();
    level.kind = kind;
    level.value = kind == Kind::object ? Json::object() : Json::array();
    return true;
  }

  bool end() {
    if (skipped_ > 0) {
      if (--skipped_ == 0) ++levels_.back().index;
      return true;
    }
    Level done = std::move(levels_.back());
    levels_.pop_back();
    if (done.kind == Kind::point) return add_point(done);
    if (done.kind == Kind::points && done.index > 0) {
      return put(Json::binary(std::move(done.points), done.rows));
    }
    return put(std::move(done.value));
  }

  bool put(Json value) {
    if (skipped_ > 0) return true;
    if (levels_.empty()) {
      root_ = std::move(value);
      return true;
    }
    Level& top = levels_.back();
    if (top.kind == Kind::points) refuse(value, "is not a point [x, y]");
    if (top.kind == Kind::point) return add_coordinate(top, value);
    if (top.longest > 0 && top.index >= top.longest) {
      throw InputError(fmt::format("{}: {}: has more than {} items", source_,
                                   place(levels_.size() - 1), top.longest));
    }
    if (!skips()) {
      if (top.kind == Kind::object) {
        top.value[top.name] = std::move(value);
      } else {
        top.value.push_back(std::move(value));
      }
    }
    ++top.index;
    return true;
  }

  bool add_coordinate(Level& top, const Json& value) {
    if (!value.is_number()) refuse(value, "is not a number");
    if (top.index < most_rows) top.point[top.index] = value.get<double>();
    if (top.index <= most_rows) top.value.push_back(value);
    ++top.index;
    return true;
  }

  bool add_point(const Level& point) {
    Level& list = levels_.back();
    if (list.index == 0) list.rows = point.index == most_rows ? most_rows : 2;
    if (point.index != list.rows) {
      refuse(point.value, list.rows == 2 ? "is not a point [x, y]" : "is not a point [x, y, z]");
    }
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(point.point.data());
    list.points.insert(list.points.end(), bytes, bytes + list.rows * sizeof(double));
    ++list.index;
    return true;
  }

  /// Of the value that comes.
  std::string pointer() const {
    std::string text;
    for (const Level& level : levels_) {
      text += '/' + (level.kind == Kind::object ? level.name : std::to_string(level.index));
    }
    return text;
  }

  /// The same of the value that comes into the first `depth` levels, for messages: names are the
  /// user's text.
  std::string place(std::size_t depth) const {
    std::string text;
    for (std::size_t i = 0; i < depth; ++i) {
      const Level& level = levels_[i];
      text +=
          '/' + (level.kind == Kind::object ? shown_name(level.name) : std::to_string(level.index));
    }
    return text.empty() ? "/" : text;
  }

  [[noreturn]] void refuse(const Json& value, const std::string& rule) const {
    throw InputError(
        fmt::format("{}: {}: {} {}", source_, place(levels_.size()), shown(value), rule));
  }

  std::string_view text_;
  std::string source_;
  const JsonForm& form_;
  Json root_;
  std::vector<Level> levels_;
  std::size_t values_ = 0;
  std::size_t skipped_ = 0;  ///< levels that are open and not kept
};

}  // namespace

Json parse_compact(std::string_view text, const std::string& source, const JsonForm& form) {
  auto reader = std::make_unique<Reader>(text, source, form);
  try {
    Json::sax_parse(text, reader.get());
    return reader->take();
  } catch (const std::bad_alloc&) {
    // A value of JSON takes memory to take apart, and throws in its destructor where there is none.
    static_cast<void>(reader.release());
    throw InputError(fmt::format("{}: needs more memory than there is", source));
  }
}

Points points_of(const Json& value) {
  const auto& bytes = value.get_binary();
  const auto rows = static_cast<Index>(bytes.subtype());
  Points points(rows, static_cast<Index>(bytes.size() / sizeof(double)) / rows);
  std::memcpy(points.data(), bytes.data(), bytes.size());
  return points;
}

Json json_of(const Points& points) {
  Json array = Json::array();
  for (Index i = 0; i < points.cols(); ++i) {
    array.push_back(std::vector<double>(points.col(i).begin(), points.col(i).end()));
  }
  return array;
}

std::string shown_name(const std::string& name) {
  const std::string quoted = shown(Json(name));
  return quoted.substr(1, quoted.size() - 2);
}

std::string shown(const Json& value) {
  constexpr std::size_t longest = 60;
  if (value.is_binary()) {
    const Points points = points_of(value).leftCols(
        std::min<Index>(4, static_cast<Index>(value.get_binary().size() / 16)));
    return shown(json_of(points));
  }
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > longest) text = text.substr(0, longest - 3) + "...";
  return text;
}

}  // namespace nuno
