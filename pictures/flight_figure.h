#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pictures/flight.h"
#include "pictures/plot.h"

namespace nuno::figures {

/// The styles of overlaid flights, in their order; they repeat after four.
std::string_view series(std::size_t i);
Marker series_marker(std::size_t i);

struct FlightFigure {
  std::string title;
  std::string subtitle;
  int ghosts = 5;      ///< poses between launch and arrival
  bool plain = false;  ///< shapes alone: no axes, no text
};

/// The figure of these flights with a title, and a subtitle that tells their errors.
FlightFigure captioned(const std::vector<Flight>& flights, bool plain);

/// Flights over one another: initial shape, target, ghosts, centroid's path and final shape, and
/// the arrival once more, enlarged.
Drawing draw_flights(const std::vector<Flight>& flights, const FlightFigure& options);

/// The moment `time` of the flights over their targets.
Drawing draw_moment(const std::vector<Flight>& flights, double time, const FlightFigure& options);

/// The flights in motion (SMIL), at `speed` times their own, with a rest at arrival.
Drawing draw_motion(const std::vector<Flight>& flights, double speed, const FlightFigure& options);

inline constexpr double rest_at_arrival = 1.5;  ///< of motion and films [s]

}  // namespace nuno::figures
