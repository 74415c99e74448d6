#pragma once

#include <span>
#include <string>
#include <vector>

#include "pictures/plot.h"

/// What the charts that set engines side by side have in common.
namespace nuno::figures {

/// Draws title and subtitle, if there are any, and below them a key for each engine; gives where
/// that line goes on.
Vec draw_heading(Drawing& drawing, const std::string& title, const std::string& subtitle,
                 std::span<const std::string> backends);

/// How the line of engine `i` looks.
std::string engine_line(std::size_t i);

/// Of a point of engine `i`; where engines agree, a later one's lies within the first's [px].
double marker_size(std::size_t i, bool small);

/// The best of engine `i` in a few words. `same` says that all engines' are one point: the first
/// then stands for all, and the others need no words.
std::string name_of_best(std::size_t i, std::span<const std::string> backends, bool same,
                         bool brief);

/// A plot over a logarithmic x, whose 0 (launch only) stands in a strip of its own, left of the
/// frame: no logarithm has a place for it.
class PlotWithZero {
 public:
  /// `box` is for both, with axes and titles.
  PlotWithZero(const Box& box, Axis x, Axis y);

  const Box& frame() const { return plot_.frame(); }
  double zero() const { return zero_; }  ///< the strip's middle [px]

  /// An x below the axis, but for 0, is on the frame's edge.
  Vec at(double x, double y) const;

  void draw_axes(Drawing& drawing) const;

 private:
  Plot plot_;
  double zero_;
};

}  // namespace nuno::figures
