#include <nuno/drawing.h>
#include <nuno/output.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <pugixml.hpp>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "svg_shapes.h"
#include "text_file.h"

namespace nuno {
namespace {

using Eigen::Affine2d;
using Eigen::Vector2d;

// A document takes about 25 times its text in memory at worst.
constexpr std::size_t largest_svg = 32 << 20;  // bytes
constexpr int deepest = 200;                   // elements within elements
constexpr int most_elements = 1'000'000;       // drawn, those of each `use` counted again
constexpr double metres_per_px = 0.0254 / 96;

/// What an element inherits from those around it.
struct Inherited {
  Affine2d map = Affine2d::Identity();  ///< from its units to metres
  Viewport viewport{NAN, NAN};
  bool hidden = false;
  int depth = 0;
  bool is_named = false;  ///< a group around it has the name that is asked for
  bool is_used = false;   ///< it is drawn by a `use`: its own names are not those of the drawing
  /// Why nothing in here can be read, to be thrown if it is asked for.
  std::string problem = {};
};

/// A curve of the name that is asked for.
struct Found {
  pugi::xml_node node;
  Inherited inherited;
};

/// Those found, and how many: more than one is too many.
struct FoundCurves {
  std::optional<Found> first;
  int count = 0;

  void add(const pugi::xml_node& node, const Inherited& inherited) {
    if (++count == 1) first = Found{node, inherited};
  }
};

/// Calls `visit(property, value)` for each declaration of a style.
void for_each_declaration(std::string_view style, const auto& visit) {
  while (!style.empty()) {
    const std::size_t end = std::min(style.find_first_of(";{}"), style.size());
    std::string_view rest = style.substr(0, end);
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    std::string_view property = rest.substr(0, colon);
    rest.remove_prefix(std::min(colon + 1, rest.size()));
    visit(next_word(property), next_word(rest));
    style.remove_prefix(std::min(end + 1, style.size()));
  }
}

std::string without_comments(std::string style) {
  for (std::size_t start = style.find("/*"); start != std::string::npos;
       start = style.find("/*", start)) {
    const std::size_t end = style.find("*/", start + 2);
    style.erase(start, end == std::string::npos ? end : end + 2 - start);
  }
  return style;
}

/// Properties of CSS that move or shape what is drawn, which are read from attributes alone.
bool shapes(std::string_view property) {
  static constexpr std::array<std::string_view, 18> properties = {"d",
                                                                  "x",
                                                                  "y",
                                                                  "width",
                                                                  "height",
                                                                  "cx",
                                                                  "cy",
                                                                  "r",
                                                                  "rx",
                                                                  "ry",
                                                                  "transform",
                                                                  "transform-origin",
                                                                  "transform-box",
                                                                  "translate",
                                                                  "rotate",
                                                                  "scale",
                                                                  "offset-path",
                                                                  "zoom"};
  return std::ranges::find(properties, property) != properties.end();
}

bool is_hiding(std::string_view property, std::string_view value) {
  return (property == "display" && value.starts_with("none")) ||
         (property == "visibility" && (value.starts_with("hidden") || value.starts_with("collap")));
}

/// Reads a document down to the curve that is asked for.
class SvgReader {
 public:
  SvgReader(const std::string& text, const std::string& source, std::string_view wanted)
      : text_(text), source_(source), wanted_(wanted) {}

  Points read() {
    const pugi::xml_parse_result parsed =
        document_.load_buffer(text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!parsed) {
      const auto offset =
          std::clamp<std::ptrdiff_t>(parsed.offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
      throw InputError(fmt::format("{}:{}: is not XML in UTF-8: {}", source_,
                                   1 + std::count(text_.begin(), text_.begin() + offset, '\n'),
                                   parsed.description()));
    }
    const pugi::xml_node root = document_.document_element();
    if (svg_kind(root) != "svg") {
      throw InputError(fmt::format("{}: has no svg element around all others", source_));
    }
    for_each_element([&](const pugi::xml_node& node) {
      if (svg_kind(node) == "style") require_harmless(node);
    });
    visit_root(root);
    return trace(chosen());
  }

 private:
  SvgElement element(const pugi::xml_node& node) const { return {text_, source_, node}; }

  /// Visits all elements, however deep they are nested.
  void for_each_element(const auto& visit) const {
    pugi::xml_node node = document_.document_element();
    while (node) {
      visit(node);
      pugi::xml_node next = node.first_child();
      for (; !next && node; node = node.parent()) next = node.next_sibling();
      node = next;
    }
  }

  /// The page: its lower left corner is the origin, where it has a height.
  void visit_root(const pugi::xml_node& root) {
    const SvgElement page = element(root);
    const auto size_of = [&](const char* attribute) -> std::optional<double> {
      if (std::string_view(root.attribute(attribute).value()).find('%') != std::string_view::npos) {
        return std::nullopt;  // of a window that is not there
      }
      return page.length(attribute, NAN);
    };
    std::optional<double> width = size_of("width"), height = size_of("height");
    if ((width && !(*width > 0)) || (height && !(*height > 0))) {
      page.value(width && !(*width > 0) ? "width" : "height").refuse("is not > 0");
    }
    Inherited inherited;
    Affine2d to_px = Affine2d::Identity();
    if (const SvgValue box_text = page.value("viewBox"); !box_text.text.empty()) {
      const ViewBox box = svg_view_box(box_text);
      const double aspect = box.size.y() / box.size.x();
      if (!width && !height) width = box.size.x();
      if (!height) height = *width * aspect;
      if (!width) width = *height / aspect;
      to_px = svg_fit(box, {0, 0}, {*width, *height}, page.value("preserveAspectRatio"));
      inherited.viewport = box.size;
    } else {
      inherited.viewport = {width.value_or(NAN), height.value_or(NAN)};
    }
    inherited.map = Eigen::Scaling(metres_per_px, -metres_per_px) *
                    Eigen::Translation2d(0, -height.value_or(0)) * to_px;
    if (root.attribute("transform")) page.value("transform").refuse("moves the page itself");
    visit_children(root, inherited);
  }

  void visit_children(const pugi::xml_node& parent, const Inherited& inherited) {
    for (const pugi::xml_node& child : parent.children()) {
      if (child.type() == pugi::node_element) visit(child, inherited);
    }
  }

  void visit(const pugi::xml_node& node, Inherited inherited) {
    if (++elements_ > most_elements) {
      throw InputError(fmt::format("{}: draws more than {} elements", source_, most_elements));
    }
    if (++inherited.depth > deepest) {
      element(node).refuse(fmt::format("is nested more than {} deep", deepest));
    }
    const std::string_view kind = svg_kind(node);
    static constexpr std::array<std::string_view, 5> containers = {"g", "a", "svg", "use",
                                                                   "switch"};
    const bool is_container = std::ranges::find(containers, kind) != containers.end();
    if (!is_container && !is_svg_shape(kind)) return;  // draws no line, and nothing in it does
    if (is_not_displayed(node, inherited)) return;
    try {
      apply_transform(node, inherited);
      if (kind == "svg") apply_viewport(node, node, inherited);
    } catch (const InputError& error) {
      inherited.problem = error.what();
    }
    if (is_svg_shape(kind)) return add(node, inherited);
    inherited.is_named = inherited.is_named || (has_wanted_name(node) && !inherited.is_used);
    if (kind == "use") return visit_used(node, inherited);
    if (kind == "switch") return visit_first_choice(node, inherited);
    visit_children(node, inherited);
  }

  /// Notes in `inherited` whether the element is visible.
  bool is_not_displayed(const pugi::xml_node& node, Inherited& inherited) const {
    bool displayed = true;
    const auto apply = [&](std::string_view property, std::string_view value) {
      if (property == "display" && !value.empty()) displayed = !is_hiding(property, value);
      if (property == "visibility" && !value.empty() && value != "inherit") {
        inherited.hidden = is_hiding(property, value);
      }
    };
    apply("display", node.attribute("display").value());
    apply("visibility", node.attribute("visibility").value());
    for_each_declaration(node.attribute("style").value(), apply);
    return !displayed;
  }

  void apply_transform(const pugi::xml_node& node, Inherited& inherited) const {
    const SvgElement at = element(node);
    for_each_declaration(node.attribute("style").value(),
                         [&](std::string_view property, std::string_view) {
                           if (!shapes(property)) return;
                           SvgValue value = at.value("style");
                           value.text = property;
                           value.refuse("is read from an attribute only, not from a style");
                         });
    for (const char* attribute : {"transform-origin", "transform-box"}) {
      if (node.attribute(attribute)) at.value(attribute).refuse("is not read");
    }
    inherited.map = inherited.map * svg_transform(at.value("transform"));
  }

  /// The viewport of an svg or symbol element; `sized` has its width and height: it, or its `use`.
  void apply_viewport(const pugi::xml_node& node, const pugi::xml_node& sized,
                      Inherited& inherited) const {
    const SvgElement at = element(node);
    const auto length = [&](const pugi::xml_node& of, const char* attribute, Index axis) {
      return element(of).length(attribute, inherited.viewport[axis]);
    };
    const auto size = [&](const char* attribute, Index axis) {
      const std::optional<double> first = length(sized, attribute, axis);
      const std::optional<double> second = first ? first : length(node, attribute, axis);
      if (second && !(*second > 0)) at.value(attribute).refuse("is not > 0");
      return second.value_or(inherited.viewport[axis]);
    };
    Vector2d corner(0, 0);
    if (svg_kind(node) == "svg") {
      corner = {length(node, "x", 0).value_or(0), length(node, "y", 1).value_or(0)};
    }
    const Viewport viewport(size("width", 0), size("height", 1));
    const SvgValue box_text = at.value("viewBox");
    if (box_text.text.empty()) {
      inherited.map = inherited.map * Eigen::Translation2d(corner);
      inherited.viewport = viewport;
      return;
    }
    if (!viewport.allFinite()) {
      box_text.refuse("is to fill a page whose size the file does not tell");
    }
    const ViewBox box = svg_view_box(box_text);
    inherited.map = inherited.map * svg_fit(box, corner, viewport, at.value("preserveAspectRatio"));
    inherited.viewport = box.size;
  }

  /// What a `use` draws: another element of the same file, at its own place.
  void visit_used(const pugi::xml_node& node, Inherited inherited) {
    const SvgElement use = element(node);
    const char* const attribute = node.attribute("href") ? "href" : "xlink:href";
    const SvgValue reference = use.value(attribute);
    inherited.is_used = true;
    pugi::xml_node used;
    try {
      if (!reference.text.starts_with('#')) {
        reference.refuse("is not #id, an element of this file; nothing else is read");
      }
      used = with_id(reference.text.substr(1));
      if (!used) reference.refuse("is no element of this file");
      if (svg_kind(used) == "svg" && (node.attribute("width") || node.attribute("height"))) {
        use.refuse("gives an svg element another size, which is not read");
      }
      const Vector2d corner(use.length("x", inherited.viewport.x()).value_or(0),
                            use.length("y", inherited.viewport.y()).value_or(0));
      inherited.map = inherited.map * Eigen::Translation2d(corner);
      if (svg_kind(used) == "symbol") apply_viewport(used, node, inherited);
    } catch (const InputError& error) {
      inherited.problem = error.what();
      return add(node, inherited);
    }
    if (svg_kind(used) != "symbol") return visit(used, inherited);
    if (++inherited.depth > deepest) use.refuse("draws itself");
    visit_children(used, inherited);
  }

  /// A switch draws its first child that asks for nothing: Illustrator puts its own data before.
  void visit_first_choice(const pugi::xml_node& node, const Inherited& inherited) {
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() == pugi::node_element && !child.attribute("requiredExtensions") &&
          !child.attribute("requiredFeatures") && !child.attribute("systemLanguage")) {
        return visit(child, inherited);
      }
    }
  }

  /// A style sheet is not read; one that moves or hides something must not be passed over.
  void require_harmless(const pugi::xml_node& node) const {
    for (const pugi::xml_node& child : node.children()) {
      for_each_declaration(
          without_comments(child.value()), [&](std::string_view property, std::string_view value) {
            if (!shapes(property) && !is_hiding(property, value)) return;
            element(node).refuse(fmt::format(
                "a style sheet that sets {} is not read; save with presentation attributes",
                shown_text(property)));
          });
    }
  }

  bool has_wanted_name(const pugi::xml_node& node) const {
    return !wanted_.empty() && (wanted_ == node.attribute("id").value() ||
                                wanted_ == node.attribute("inkscape:label").value());
  }

  void add(const pugi::xml_node& node, const Inherited& inherited) {
    if (inherited.hidden || !draws(node)) return;
    ++curves_;
    std::string_view name = node.attribute("inkscape:label").value();
    if (name.empty()) name = node.attribute("id").value();
    if (!name.empty() && names_.size() < 8 && names_length_ < 120 && !inherited.is_used) {
      names_.push_back(shown_text(name));
      names_length_ += names_.back().size();
    }
    if (wanted_.empty() || (has_wanted_name(node) && !inherited.is_used)) {
      own_.add(node, inherited);
    } else if (inherited.is_named) {
      grouped_.add(node, inherited);
    }
  }

  /// Whether an element has what it draws: "none" and nothing at all are no mistakes.
  static bool draws(const pugi::xml_node& node) {
    const std::string_view kind = svg_kind(node);
    if (kind == "path") {
      const std::string_view d = node.attribute("d").value();
      return d != "none" && d.find_first_not_of(" \t\r\n") != std::string_view::npos;
    }
    return !kind.starts_with("poly") || *node.attribute("points").value() != '\0';
  }

  pugi::xml_node with_id(std::string_view id) {
    if (ids_.empty()) {
      for_each_element([&](const pugi::xml_node& node) {
        if (const char* const value = node.attribute("id").value(); *value) {
          ids_.emplace(value, node);
        }
      });
    }
    const auto found = ids_.find(id);
    return found == ids_.end() ? pugi::xml_node() : found->second;
  }

  const Found& chosen() const {
    const FoundCurves& found = own_.count > 0 ? own_ : grouped_;
    if (found.count == 1) return *found.first;
    if (curves_ == 0) throw InputError(fmt::format("{}: draws no path", source_));
    const std::string names =
        names_.empty()
            ? "none of them has an id"
            : fmt::format("\"{}\"{}", fmt::join(names_, "\", \""),
                          static_cast<std::size_t>(curves_) > names_.size() ? ", …" : "");
    if (wanted_.empty()) {
      throw InputError(fmt::format("{}: draws {} paths; name one as {}#ID: {}", source_, curves_,
                                   source_, names));
    }
    throw InputError(fmt::format("{}: draws {} paths named \"{}\", not one; its paths: {}", source_,
                                 found.count, shown_text(wanted_), names));
  }

  Points trace(const Found& found) const {
    if (!found.inherited.problem.empty()) throw InputError(found.inherited.problem);
    const SvgElement at = element(found.node);
    const SvgPath path = svg_shape(at, found.inherited.viewport);
    if (path.subpaths() > 1) {
      at.refuse(fmt::format("has {} subpaths, and a cloth is one line; break the path apart",
                            path.subpaths()));
    }
    Points points = flattened(path, found.inherited.map);
    if (points.cols() < 2) at.refuse("draws nothing");
    if (!points.allFinite()) at.refuse("is drawn beyond all bounds by its transforms");
    return points;
  }

  const std::string& text_;
  const std::string& source_;
  std::string_view wanted_;
  pugi::xml_document document_;
  std::unordered_map<std::string_view, pugi::xml_node> ids_;
  int elements_ = 0;
  int curves_ = 0;                  ///< drawn
  std::vector<std::string> names_;  ///< of the first of them, for messages
  std::size_t names_length_ = 0;
  FoundCurves own_, grouped_;  ///< with the name themselves, or in a group with it
};

}  // namespace

Points parse_svg(const std::string& text, const std::string& source, const std::string& name) {
  if (text.size() > largest_svg) {
    throw InputError(fmt::format("{}: is larger than {} MiB", source, largest_svg >> 20));
  }
  return SvgReader(text, source, name).read();
}

}  // namespace nuno
