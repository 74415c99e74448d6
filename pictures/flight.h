#pragma once

#include <nuno/backend.h>
#include <nuno/rollout.h>

#include <string>
#include <string_view>
#include <vector>

namespace nuno::figures {

/// A throw, ready to be drawn; from a rollout that kept frames or from a result file.
struct Flight {
  std::string scene;
  std::string backend;
  double gain = 0;                ///< α [N/m]
  double cloth_length = 0;        ///< L [m]
  double error = 0;               ///< mean, at arrival [m]
  double max_error = 0;           ///< of the worst particle [m]
  Points target;                  ///< [d × N], m; d = 2 of a chain, 3 of a sheet
  Faces faces;                    ///< of a sheet
  std::vector<Index> stroke;      ///< particles in the order in which a line draws the cloth
  std::vector<double> times;      ///< of the frames, ascending, the last at arrival [s]
  std::vector<Points> positions;  ///< [d × N] each, m
};

/// One line along every edge of a connected cloth, from particle 0 on; where it cannot go on it
/// goes back over itself.
std::vector<Index> stroke_along(const Edges& edges);

/// Of a picture in space: the unit vector to who looks at it.
Eigen::Vector3d to_the_eye();

/// Points [d × any] as a picture shows them [2 × any], m: those in space from a fixed side.
Points seen(const Points& points);

Flight make_flight(const std::string& scene, const Backend& backend, const Rollout& rollout);

/// The cloth at any time, between frames on the straight way, before and after them at rest.
Points positions_at(const Flight& flight, double time);

/// When the last of them arrives [s].
double last_arrival(const std::vector<Flight>& flights);

/// The name that an engine has for people.
std::string engine_name(std::string_view backend);

}  // namespace nuno::figures
