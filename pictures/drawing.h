#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

/// A small layer that writes SVG: lines, markers, text, and labels that find their own place.
namespace nuno::figures {

/// A place or an extent on the drawing [px], y down.
struct Vec {
  double x = 0, y = 0;
};

struct Box {
  double left = 0, top = 0, width = 0, height = 0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

enum class Anchor { start, middle, end };

enum class Marker { circle, square, diamond, triangle, ring };

/// How much a label minds to stand on something.
enum class Weight { none, light, heavy };

/// The style sheet of every drawing: light, dark where the reader's system is, light on paper.
/// Styles are its classes; `line`, `dot` and `text` take one or several of them.
std::string style_sheet();

/// A text as XML holds it: escaped, without codes that XML has no place for, valid UTF-8.
std::string xml_text(std::string_view text);

/// How wide a text is at most, in a common font [px].
double text_width(std::string_view text, std::string_view style = "");

/// "x,y x,y …" to a hundredth of a pixel.
std::string svg_points(std::span<const Vec> points);

class Drawing {
 public:
  /// `title` is what a screen reader says.
  Drawing(Vec size, std::string title) : size_(size), title_(std::move(title)) {}

  Vec size() const { return size_; }

  void line(std::span<const Vec> points, std::string_view style, Weight weight = Weight::heavy);
  void line(Vec from, Vec to, std::string_view style, Weight weight = Weight::none);
  void marker(Marker marker, Vec at, double size, std::string_view style,
              Weight weight = Weight::heavy);
  void text(Vec at, std::string_view text, Anchor anchor, std::string_view style = "");
  void vertical_text(Vec at, std::string_view text, std::string_view style = "");
  void rectangle(const Box& box, std::string_view style);

  /// A text beside a place, inside `inside`, where it covers least of what was or will be drawn; a
  /// thin leader shows what it belongs to if it stands apart.
  void label(Vec place, std::string_view text, std::string_view style, const Box& inside);

  /// What comes until `end_clip` is cut at the box.
  void begin_clip(const Box& box);
  void end_clip();

  /// Elements of the caller's own.
  void raw(std::string_view elements) { body_ += elements; }

  /// The whole file; without the style sheet, for a page that has it.
  std::string svg(bool with_style = true) const;

 private:
  struct Label {
    Vec place;
    std::string text;
    std::string style;
    Box inside;
  };
  struct Obstacle {
    Vec at;
    double cost;
  };

  /// Where a label might stand, and how bad that would be.
  struct Placement {
    Vec at;
    Anchor anchor = Anchor::middle;
    double distance = 0;  ///< from the place that it belongs to [px]
    Vec way;              ///< from there, of length 1
    double cost = 0;
  };

  void mind(Vec at, Weight weight);
  void mind_line(Vec from, Vec to, Weight weight);
  Placement placed(const Label& label, double distance, Vec way,
                   const std::vector<Box>& taken) const;
  Placement best_placement(const Label& label, const std::vector<Box>& taken) const;
  std::string placed_labels() const;

  Vec size_;
  std::string title_;
  std::string body_;
  std::vector<Label> labels_;
  std::vector<Obstacle> obstacles_;
  std::vector<Box> texts_;
};

}  // namespace nuno::figures
