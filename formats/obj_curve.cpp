#include <nuno/drawing.h>

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "text_file.h"

namespace nuno {
namespace {

constexpr double flat = 1e-4;  // of a curve's size: what exporters round away

/// A segment of a line, as the file has it.
struct Edge {
  Index from = 0, to = 0;
};

/// The edges of one object.
struct Object {
  std::string name;
  std::vector<Edge> edges;
  Index line = 0;  ///< of the first edge
};

struct ObjLines {
  std::vector<double> vertices;
  std::vector<Object> objects;  ///< those with an edge

  Index vertex_count() const { return static_cast<Index>(vertices.size() / 3); }
};

ObjLines read_lines(const std::string& text, const std::string& source) {
  ObjLines lines;
  std::string name;
  bool is_new = true;  // the next edge is the first of its object
  for_each_obj_line(text, source, [&](std::string_view words, const Line& line) {
    const std::string_view statement = next_word(words);
    if (statement == "v") {
      for (int k = 0; k < 3; ++k) {
        const std::string_view word = next_word(words);
        if (word.empty()) line.refuse(statement, "has not 3 numbers");
        lines.vertices.push_back(number(word, line));
      }
    } else if (statement == "o" || statement == "g") {
      name = std::string(next_word(words));
      is_new = true;
    } else if (statement == "l") {
      const auto vertex = [&](std::string_view word) {
        return obj_index(word.substr(0, word.find('/')), word, lines.vertex_count(), "vertex",
                         line);
      };
      const std::string_view first = next_word(words);
      std::string_view second = next_word(words);
      if (second.empty()) line.refuse(statement, "has fewer than 2 vertices");
      if (is_new) lines.objects.push_back({name, {}, line.number});
      is_new = false;
      for (Index from = vertex(first); !second.empty(); second = next_word(words)) {
        const Index to = vertex(second);
        lines.objects.back().edges.push_back({from, to});
        from = to;
      }
    }
  });
  return lines;
}

/// The object called `name`, or the only one for "".
const Object& chosen(const ObjLines& lines, const std::string& source, const std::string& name) {
  const auto is_asked = [&](const Object& each) { return name.empty() || each.name == name; };
  const auto count = std::ranges::count_if(lines.objects, is_asked);
  if (count == 1) return *std::ranges::find_if(lines.objects, is_asked);
  if (lines.objects.empty()) throw InputError(fmt::format("{}: has no line (l)", source));
  std::vector<std::string> names;
  for (const Object& each : lines.objects) {
    if (names.size() < 8) names.push_back(shown_text(each.name));
  }
  throw InputError(fmt::format("{}: has {} objects with lines{}, not one: \"{}\"{}", source, count,
                               name.empty() ? "" : fmt::format(" named \"{}\"", shown_text(name)),
                               fmt::join(names, "\", \""),
                               names.size() < lines.objects.size() ? ", …" : ""));
}

/// The vertices along a curve's edges, which may stand in any order and direction.
class EdgeChain {
 public:
  EdgeChain(const Object& object, const std::string& source) : object_(object), source_(source) {
    for (std::size_t k = 0; k < object.edges.size(); ++k) {
      const auto [from, to] = object.edges[k];
      if (from == to) continue;  // of no length
      ++count_;
      at_vertex_.emplace_back(from, k);
      at_vertex_.emplace_back(to, k);
    }
    std::ranges::sort(at_vertex_);
  }

  std::vector<Index> vertices() const {
    if (count_ == 0) refuse("all its segments have no length");
    std::vector<Index> chain = {first_vertex()};
    std::size_t last_edge = object_.edges.size();  // none
    for (std::size_t k = 0; k < count_; ++k) {
      const auto next = edge_at(chain.back(), last_edge);
      const bool is_round = k > 0 && chain.back() == chain.front();
      if (next == object_.edges.size() || is_round) {
        refuse("its segments are not one line: there is a gap");
      }
      const auto [from, to] = object_.edges[next];
      chain.push_back(from == chain.back() ? to : from);
      last_edge = next;
    }
    return chain;
  }

 private:
  using Entry = std::pair<Index, std::size_t>;  ///< a vertex and an edge of it

  /// The end at which the file begins a segment, of a closed curve the start of its first segment.
  Index first_vertex() const {
    std::vector<Entry> ends;
    for (std::size_t start = 0; start < at_vertex_.size();) {
      std::size_t end = start;
      while (end < at_vertex_.size() && at_vertex_[end].first == at_vertex_[start].first) ++end;
      if (end - start > 2) {
        refuse(fmt::format("{} segments meet at vertex {}: a cloth is one line", end - start,
                           at_vertex_[start].first + 1));
      }
      if (end - start == 1) ends.push_back(at_vertex_[start]);
      start = end;
    }
    for (const auto& [vertex, edge] : ends) {
      if (object_.edges[edge].from == vertex) return vertex;
    }
    if (!ends.empty()) return ends.front().first;
    return std::ranges::find_if(object_.edges, [](const Edge& e) { return e.from != e.to; })->from;
  }

  /// The edge at a vertex that is not the last one, or none. A closed curve starts along its
  /// first.
  std::size_t edge_at(Index vertex, std::size_t last) const {
    auto place = std::ranges::lower_bound(at_vertex_, Entry{vertex, 0});
    for (; place != at_vertex_.end() && place->first == vertex; ++place) {
      if (place->second != last) return place->second;
    }
    return object_.edges.size();
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}:{}: object \"{}\": {}", source_, object_.line,
                                 shown_text(object_.name), what));
  }

  const Object& object_;
  const std::string& source_;
  std::size_t count_ = 0;
  std::vector<Entry> at_vertex_;
};

}  // namespace

Points parse_obj_curve(const std::string& text, const std::string& source,
                       const std::string& name) {
  const ObjLines lines = read_lines(text, source);
  const Object& object = chosen(lines, source, name);
  const Eigen::Map<const Points> all(lines.vertices.data(), 3, lines.vertex_count());
  const Points points = all(Eigen::all, EdgeChain(object, source).vertices());
  const Eigen::Vector3d size = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  if (!(size.z() <= flat * size.norm())) {
    throw InputError(
        fmt::format("{}:{}: object \"{}\": its z goes over {:.4g}, it is not a curve of x and y; "
                    "draw it in the "
                    "front view, and export with y up",
                    source, object.line, shown_text(object.name), size.z()));
  }
  return points.topRows(2);
}

}  // namespace nuno
