#include <nuno/mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "text_file.h"

namespace nuno {
namespace {

constexpr std::size_t most_corners = 1000;     // of a face
constexpr std::size_t most_properties = 1000;  // of an element

enum class Format { ascii, little_endian, big_endian };

struct Type {
  std::string_view name, old_name;
  std::size_t size;  ///< bytes
  bool is_integer, is_signed;
};

constexpr std::array types = {
    Type{"int8", "char", 1, true, true},      Type{"uint8", "uchar", 1, true, false},
    Type{"int16", "short", 2, true, true},    Type{"uint16", "ushort", 2, true, false},
    Type{"int32", "int", 4, true, true},      Type{"uint32", "uint", 4, true, false},
    Type{"float32", "float", 4, false, true}, Type{"float64", "double", 8, false, true}};

struct Property {
  std::string_view name;
  const Type* type;
  const Type* count_type = nullptr;  ///< of a list
};

struct Element {
  std::string_view name;
  std::int64_t count;
  std::vector<Property> properties;
};

/// What is left of a file, and where that is, for messages.
struct Place {
  const std::string& source;
  std::string_view rest;
  Index line = 0;  ///< the last that was read; 0 where there are none
  const Element* element = nullptr;
  std::int64_t row = 0;  ///< of the element, from 0 on

  [[noreturn]] void refuse(std::string_view value, const std::string& rule) const {
    std::string at = line > 0 ? fmt::format(":{}", line) : "";
    if (line == 0 && element) at = fmt::format(": {} {}", shown_text(element->name), row);
    throw InputError(fmt::format("{}{}: {} {}", source, at, shown_text(value), rule));
  }

  /// The next line, without its end.
  std::optional<std::string_view> next_line() {
    if (rest.empty()) return {};
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view text = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    ++line;
    while (text.ends_with('\r')) text.remove_suffix(1);
    return text;
  }
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
};

const Type& find_type(std::string_view word, const Place& place) {
  const auto found = std::ranges::find_if(
      types, [&](const Type& type) { return word == type.name || word == type.old_name; });
  if (found == types.end()) place.refuse(word, "is not a type of PLY");
  return *found;
}

Property read_property(std::string_view rest, std::string_view line, const Place& place) {
  Property property{};
  std::string_view word = next_word(rest);
  if (word == "list") {
    word = next_word(rest);
    property.count_type = &find_type(word, place);
    if (!property.count_type->is_integer)
      place.refuse(word, "does not count: it is no integer type");
    word = next_word(rest);
  }
  property.type = &find_type(word, place);
  property.name = next_word(rest);
  if (property.name.empty() || !next_word(rest).empty()) {
    place.refuse(line, "is not \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"");
  }
  return property;
}

Element read_element(std::string_view rest, std::string_view line, const Place& place) {
  const std::string_view name = next_word(rest), digits = next_word(rest);
  std::int64_t count = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size() || count < 0 ||
      !next_word(rest).empty()) {
    place.refuse(line, "is not \"element NAME COUNT\"");
  }
  const Index most = name == "vertex" ? most_file_vertices : most_file_faces;
  if ((name == "vertex" || name == "face") && count > most) {
    place.refuse(digits, fmt::format("{} elements are not <= {}", name, most));
  }
  return {name, count, {}};
}

Format read_format(std::string_view rest, std::string_view line, const Place& place) {
  constexpr std::array names = {"ascii", "binary_little_endian", "binary_big_endian"};
  const auto found = std::ranges::find(names, next_word(rest));
  if (found == names.end() || next_word(rest) != "1.0" || !next_word(rest).empty()) {
    place.refuse(line, fmt::format("is not \"format {} 1.0\"", fmt::join(names, " or ")));
  }
  return static_cast<Format>(found - names.begin());
}

Header read_header(Place& place) {
  Header header;
  if (place.next_line() != "ply") place.refuse("the first line", "is not \"ply\"");
  for (bool has_format = false;;) {
    const auto line = place.next_line();
    if (!line) place.refuse("the header", "has no \"end_header\"");
    std::string_view rest = *line;
    const std::string_view word = next_word(rest);
    if (word == "end_header") {
      if (!has_format) place.refuse(word, "stands before any \"format\"");
      return header;
    }
    if (word == "format") {
      header.format = read_format(rest, *line, place);
      has_format = true;
    } else if (word == "element") {
      const Element element = read_element(rest, *line, place);
      if (std::ranges::count(header.elements, element.name, &Element::name) > 0) {
        place.refuse(element.name, "is an element that stands twice");
      }
      header.elements.push_back(element);
    } else if (word == "property") {
      if (header.elements.empty()) place.refuse(*line, "stands before any element");
      auto& properties = header.elements.back().properties;
      properties.push_back(read_property(rest, *line, place));
      if (properties.size() > most_properties) {
        place.refuse(*line,
                     fmt::format("is more than {} properties of an element", most_properties));
      }
    } else if (!word.empty() && word != "comment" && word != "obj_info") {
      place.refuse(word, "is not a statement of a PLY header");
    }
  }
}

/// Reads the values of rows, one after another.
class Rows {
 public:
  Rows(Place& place, Format format) : place_(place), format_(format) {}

  void start() {
    if (format_ != Format::ascii) return;
    do {
      const auto line = place_.next_line();
      if (!line) end_of_file();
      row_ = *line;
    } while (row_.find_first_not_of(line_blanks) == std::string_view::npos);
    left_ = row_;
  }

  double number(const Type& type) {
    return format_ == Format::ascii ? written(type) : stored(type);
  }

  /// Passes over so many values.
  void skip(std::int64_t count, const Type& type) {
    if (format_ == Format::ascii) {
      for (std::int64_t i = 0; i < count; ++i) written(type);
    } else {
      bytes(static_cast<std::uint64_t>(count) * type.size);
    }
  }

  std::int64_t list_length(const Property& list) {
    const double count = number(*list.count_type);
    if (count < 0) place_.refuse(fmt::format("{}", count), "is not >= 0, a length of a list");
    return static_cast<std::int64_t>(count);
  }

  void finish() {
    if (format_ != Format::ascii) return;
    if (const auto word = next_word(left_); !word.empty()) {
      place_.refuse(word, "is one value more than the header says");
    }
  }

 private:
  [[noreturn]] void end_of_file() {
    place_.line = 0;
    place_.refuse(
        "the element",
        fmt::format("is not there: the file ends before the {} elements that the header says",
                    place_.element->count));
  }

  std::string_view bytes(std::uint64_t count) {
    if (count > place_.rest.size()) end_of_file();
    const std::string_view result = place_.rest.substr(0, count);
    place_.rest.remove_prefix(count);
    return result;
  }

  double written(const Type& type) {
    const std::string_view word = next_word(left_);
    if (word.empty()) place_.refuse(row_, "has fewer values than the header says");
    const std::optional<double> found = number_in(word);
    if (!found) place_.refuse(word, "is not a number");
    const double value = *found;
    if (type.is_integer && (value != std::floor(value) || std::abs(value) > 0x1p32)) {
      place_.refuse(word, fmt::format("is not a number of type {}", type.name));
    }
    return value;
  }

  double stored(const Type& type) {
    const std::string_view raw = bytes(type.size);
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const std::size_t from = format_ == Format::big_endian ? i : raw.size() - 1 - i;
      word = word << 8 | static_cast<unsigned char>(raw[from]);
    }
    if (type.is_integer) {
      const std::uint64_t sign = std::uint64_t{1} << (8 * type.size - 1);
      const auto value = static_cast<double>(word);
      return type.is_signed && (word & sign) != 0 ? value - 2 * static_cast<double>(sign) : value;
    }
    return type.size == 4
               ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(word)))
               : std::bit_cast<double>(word);
  }

  Place& place_;
  Format format_;
  std::string_view row_, left_;  // ascii: the line, and what of it is not read yet
};

/// Where a property of these names stands among an element's; none if there is no such.
std::optional<std::size_t> find(const Element& element, bool is_list,
                                std::initializer_list<std::string_view> names) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const Property& property = element.properties[i];
    if ((property.count_type != nullptr) == is_list &&
        std::ranges::find(names, property.name) != names.end()) {
      return i;
    }
  }
  return {};
}

/// Collects a file's vertices and faces.
class Reader {
 public:
  Reader(Place& place, const Header& header) : place_(place), rows_(place, header.format) {
    for (const Element& element : header.elements) {
      if (element.name == "vertex") vertices_ = element.count;
    }
  }

  void read(const Element& element) {
    place_.element = &element;
    if (element.name == "vertex") choose_columns(element);
    const auto corners = element.name == "face"
                             ? find(element, true, {"vertex_indices", "vertex_index"})
                             : std::nullopt;
    if (element.name == "face" && !corners) {
      refuse_header("face", "a list vertex_indices");
    }
    if (element.properties.empty()) return;  // its rows are empty
    for (place_.row = 0; place_.row < element.count; ++place_.row) {
      rows_.start();
      if (element.name == "vertex") {
        read_vertex(element);
      } else {
        read_row(element, corners);
      }
      rows_.finish();
    }
  }

  Mesh finish() {
    if (mesh_.faces.empty()) {
      throw InputError(fmt::format("{}: has no face; a mesh is required", place_.source));
    }
    mesh_.vertices = Eigen::Map<const Points>(coordinates_.data(), 3, vertices_);
    if (!textures_.empty()) {
      mesh_.texture_coordinates = Eigen::Map<const Points>(textures_.data(), 2, vertices_);
      mesh_.texture_corners = mesh_.faces;
    }
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse_header(std::string_view element, std::string_view property) const {
    throw InputError(
        fmt::format("{}: the element {} has not {}", place_.source, element, property));
  }

  void choose_columns(const Element& element) {
    columns_.clear();
    for (const auto name : {"x", "y", "z"}) {
      const auto column = find(element, false, {name});
      if (!column) refuse_header("vertex", fmt::format("the property {}", name));
      columns_.push_back(*column);
    }
    const auto u = find(element, false, {"s", "u", "texture_s", "texture_u"});
    const auto v = find(element, false, {"t", "v", "texture_t", "texture_v"});
    if (u && v) columns_.insert(columns_.end(), {*u, *v});
    mesh_.splits_seams = columns_.size() > 3 || find(element, false, {"nx"});
  }

  void read_vertex(const Element& element) {
    values_.assign(element.properties.size(), 0);
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& property = element.properties[i];
      if (property.count_type) {
        rows_.skip(rows_.list_length(property), *property.type);
      } else {
        values_[i] = rows_.number(*property.type);
      }
    }
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const double value = values_[columns_[k]];
      if (!(std::abs(value) <= largest_scene_number)) {
        place_.refuse(fmt::format("{}", value),
                      fmt::format("is not within ±{}", largest_scene_number));
      }
      (k < 3 ? coordinates_ : textures_).push_back(value);
    }
  }

  void read_row(const Element& element, std::optional<std::size_t> corners) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& property = element.properties[i];
      const std::int64_t count = property.count_type ? rows_.list_length(property) : 1;
      if (i == corners) {
        read_face(property, count);
      } else {
        rows_.skip(count, *property.type);
      }
    }
  }

  void read_face(const Property& property, std::int64_t count) {
    if (count < 3 || count > static_cast<std::int64_t>(most_corners)) {
      place_.refuse(fmt::format("{}", count),
                    fmt::format("corners are not within 3 … {}", most_corners));
    }
    std::vector<Index> face;
    for (std::int64_t k = 0; k < count; ++k) {
      const double value = rows_.number(*property.type);
      if (!(value >= 0 && value < static_cast<double>(vertices_) && value == std::floor(value))) {
        place_.refuse(fmt::format("{}", value),
                      fmt::format("names a vertex that is not among the {}", vertices_));
      }
      face.push_back(static_cast<Index>(value));
      if (std::ranges::count(face, face.back()) > 1) {
        place_.refuse(fmt::format("{}", value), "stands twice in the face");
      }
    }
    mesh_.faces.push_back(std::move(face));
    if (place_.line > 0) mesh_.lines.push_back(place_.line);
  }

  Place& place_;
  Rows rows_;
  std::int64_t vertices_ = 0;
  std::vector<std::size_t> columns_;  // of x, y, z and of texture coordinates, if it has them
  std::vector<double> values_, coordinates_, textures_;
  Mesh mesh_;
};

}  // namespace

Mesh parse_ply(const std::string& text, const std::string& source) {
  Place place{source, text};
  const Header header = read_header(place);
  if (header.format != Format::ascii) place.line = 0;
  Reader reader(place, header);
  for (const Element& element : header.elements) reader.read(element);
  const std::size_t more = place.rest.find_first_not_of(" \t\r\n");
  if (more != std::string_view::npos) {
    throw InputError(fmt::format("{}: goes on after the elements that its header says", source));
  }
  return reader.finish();
}

}  // namespace nuno
