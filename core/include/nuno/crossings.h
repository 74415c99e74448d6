#pragma once

#include <nuno/problem.h>

#include <array>
#include <vector>

namespace nuno {

// Where a sheet passes through itself, or through the ground. Nothing keeps it from that yet; this
// says so. Pure geometry: a shape is the vertices of the faces [3 × N], m, y up.

/// Two triangles that pass through each other.
struct Crossing {
  std::array<Index, 2> faces;  ///< that they are of, the smaller number first
  /// How far the one reaches through the other [m]: where its edges pierce it, how far an edge's
  /// nearer end is behind the plane, at most; of both ways round the smaller.
  double depth = 0;
};

/// Every pair of triangles without a common vertex of which an edge of the one pierces the other.
/// Faces of more than 3 corners are fans about their first. What only touches does not cross.
std::vector<Crossing> crossings(const Points& shape, const Faces& faces);

/// What of a flight does so, frame by frame.
struct FlightCrossings {
  Index frames = 0;           ///< that were looked at
  Index crossed_frames = 0;   ///< in which the sheet passes through itself
  Index most_pairs = 0;       ///< of triangles in one frame
  double first_time = 0;      ///< of a crossed frame [s]
  double depth = 0;           ///< the deepest of all [m]
  double deepest_time = 0;    ///< when that is [s]
  Index grounded_frames = 0;  ///< in which a vertex is below the ground
  double ground_time = 0;     ///< the first of them [s]
  double ground_depth = 0;    ///< how far the lowest vertex of all is below it [m]
  /// Of each frame the faces that cross another one, ascending.
  std::vector<std::vector<Index>> crossed_faces;
};

/// `times` [s] are those of the frames `positions`; `ground` is its height [m], see ground_height.
FlightCrossings flight_crossings(const std::vector<double>& times,
                                 const std::vector<Points>& positions, const Faces& faces,
                                 double ground);

/// The same of a sheet's flight.
FlightCrossings flight_crossings(const Problem& problem, const std::vector<double>& times,
                                 const std::vector<Points>& positions);

/// y = 0, or where one of the drawn shapes is below that, the lowest of their vertices.
double ground_height(const Points& initial, const Points& target);

}  // namespace nuno
