#pragma once

#include <string>
#include <vector>

#include "pictures/drawing.h"

namespace nuno::figures {

enum class Scale { linear, logarithmic };

/// What an axis measures, and from where to where.
struct Axis {
  std::string title;  ///< with its unit: "x [m]"
  double low = 0, high = 1;
  Scale scale = Scale::linear;
};

struct Tick {
  double value = 0;
  std::string label;  ///< empty: a minor tick
};

/// About `count` round values from low to high (1, 2 or 5 times a power of ten), or the powers of
/// ten, with 2 … 9 times them as minor ticks (2 and 5 named where there are few powers).
std::vector<Tick> ticks(const Axis& axis, int count);

/// A value with three digits, as people write it: "0.0181", "12", "1.2·10⁻⁵".
std::string shown(double value);

/// A frame with two axes: values in, places on the drawing out.
class Plot {
 public:
  Plot(const Box& frame, Axis x, Axis y) : frame_(frame), x_(std::move(x)), y_(std::move(y)) {}

  const Box& frame() const { return frame_; }
  const Axis& x() const { return x_; }
  const Axis& y() const { return y_; }

  Vec at(double x, double y) const;

  /// Grid, ticks, numbers, titles; `left` is how far left of the frame y's numbers stand [px].
  void draw_axes(Drawing& drawing, double left = 7) const;

  /// Makes the ranges larger about their centres until a metre is as long in x as in y.
  static Plot with_equal_scales(const Box& frame, Axis x, Axis y);

 private:
  Box frame_;
  Axis x_, y_;
};

}  // namespace nuno::figures
