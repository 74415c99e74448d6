#pragma once

#include <string>
#include <string_view>

#include "pictures/flight.h"
#include "pictures/plot.h"

namespace nuno::figures {

// A sheet in space as a picture shows it: shaded faces, the far ones first (painter's algorithm,
// Newell, Newell and Sancha 1972, by the faces' middles), lit from above on both their sides.

/// How a pose is painted.
struct Paint {
  std::string_view color = "a";  ///< a style of series, "target" or "soft"
  double opacity = 1;
};

/// Elements for Drawing::raw that paint the faces of a pose [3 × N].
std::string shaded(const Plot& plot, const Faces& faces, const Points& pose, const Paint& paint);

/// Where the pose throws its shadow on the ground at this height, straight down but for a little
/// [3 × N].
Points shadow_of(const Points& pose, double ground);

/// Elements that paint that shadow, soft at its rim.
std::string soft_shadow(const Plot& plot, const Faces& faces, const Points& pose, double ground);

}  // namespace nuno::figures
