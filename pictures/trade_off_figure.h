#pragma once

#include <nuno/trade_off.h>

#include <string>
#include <vector>

#include "pictures/drawing.h"

namespace nuno::figures {

/// What one engine pays for an error: its flights in ascending gain, launch only the first.
struct TradeOffCurve {
  std::string backend;
  std::vector<TradeOffPoint> flights;
  TradeOffPoint best;  ///< of least error
};

/// Flights of all engines that a page plays together.
struct TradeOffPick {
  std::vector<TradeOffPoint> places;  ///< one for each engine
  bool has_dots = false;              ///< to click at
};

/// `count` of an engine's best trades, evenly along their line in the figure, without launch only.
std::vector<TradeOffPoint> spread_along(const TradeOffCurve& curve, std::size_t count);

struct TradeOffFigure {
  std::string title;
  std::string subtitle;
  double width = 800, height = 430;
  std::string effort_unit;
  /// Each a group of dots and one of rings with its number as data-choice, of which a script shows
  /// the one picked; at first that is the first.
  std::vector<TradeOffPick> picks;
};

/// Error at arrival against control effort, both logarithmic: every flight, and broad those that no
/// other beats in both.
Drawing draw_trade_off(const std::vector<TradeOffCurve>& curves, double cloth_length,
                       const TradeOffFigure& options);

}  // namespace nuno::figures
