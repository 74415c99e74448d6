#pragma once

#include <nuno/pareto_front.h>

#include <string>
#include <vector>

#include "pictures/drawing.h"

namespace nuno::figures {

/// What one engine pays for an error: its flights in ascending gain, launch only the first.
struct ParetoCurve {
  std::string backend;
  std::vector<ParetoPoint> flights;
  ParetoPoint best;  ///< of least error
};

/// Flights of all engines that a page plays together.
struct ParetoPick {
  std::vector<ParetoPoint> places;  ///< one for each engine
  bool has_dots = false;            ///< to click at
};

/// `count` of an engine's best pareto, evenly along their line in the figure, without launch only.
std::vector<ParetoPoint> spread_along(const ParetoCurve& curve, std::size_t count);

struct ParetoFigure {
  std::string title;
  std::string subtitle;
  double width = 800, height = 430;
  std::string effort_unit;
  /// Each a group of dots and one of rings with its number as data-choice, of which a script shows
  /// the one picked; at first that is the first.
  std::vector<ParetoPick> picks;
};

/// Error at arrival against control effort, both logarithmic: every flight, and broad those that no
/// other beats in both.
Drawing draw_pareto_front(const std::vector<ParetoCurve>& curves, double cloth_length,
                          const ParetoFigure& options);

}  // namespace nuno::figures
