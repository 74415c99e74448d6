#include "pictures/flight.h"

#include <nuno/engines.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nuno::figures {
namespace {

/// Of a sheet: from the front, a little from the right and from above.
constexpr double azimuth = 25 * std::numbers::pi / 180, elevation = 20 * std::numbers::pi / 180;

}  // namespace

std::string engine_name(std::string_view backend) {
  const auto known = std::ranges::find(all_engines, backend, &EngineEntry::name);
  return std::string(known == all_engines.end() ? backend : known->name_for_people);
}

Flight make_flight(const std::string& scene, const Backend& backend, const Rollout& rollout) {
  return {.scene = scene,
          .backend = std::string(backend.name()),
          .gain = rollout.gains.rest,
          .cloth_length = backend.problem().cloth().size,
          .error = rollout.error.mean,
          .max_error = rollout.error.max,
          .target = backend.problem().target,
          .faces = backend.problem().is_sheet() ? backend.problem().sheet().faces : Faces(),
          .stroke = stroke_along(backend.cloth().edges),
          .times = rollout.frame_times,
          .positions = rollout.frame_positions};
}

std::vector<Index> stroke_along(const Edges& edges) {
  struct End {
    Index other, edge;
  };
  std::vector<std::vector<End>> ends(static_cast<std::size_t>(edges.maxCoeff() + 1));
  for (Index e = edges.cols(); e-- > 0;) {  // taken from the back
    ends[static_cast<std::size_t>(edges(0, e))].push_back({edges(1, e), e});
    ends[static_cast<std::size_t>(edges(1, e))].push_back({edges(0, e), e});
  }
  std::vector<bool> drawn(static_cast<std::size_t>(edges.cols()), false);
  std::vector<Index> stroke = {0}, way = {0};
  for (Index left = edges.cols(); left > 0;) {
    auto& here = ends[static_cast<std::size_t>(way.back())];
    while (!here.empty() && drawn[static_cast<std::size_t>(here.back().edge)]) here.pop_back();
    if (here.empty() && way.size() == 1) break;  // what is left hangs on nothing drawn
    if (here.empty()) {
      way.pop_back();  // back along the line, to where one is left
    } else {
      drawn[static_cast<std::size_t>(here.back().edge)] = true;
      way.push_back(here.back().other);
      --left;
    }
    stroke.push_back(way.back());
  }
  return stroke;
}

Eigen::Vector3d to_the_eye() {
  return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
          std::cos(azimuth) * std::cos(elevation)};
}

Points seen(const Points& points) {
  if (points.rows() == 2) return points;
  Eigen::Matrix<double, 2, 3> view;
  view << std::cos(azimuth), 0, -std::sin(azimuth),  //
      -std::sin(azimuth) * std::sin(elevation), std::cos(elevation),
      -std::cos(azimuth) * std::sin(elevation);
  return view * points;
}

Points positions_at(const Flight& flight, double time) {
  const auto next = std::ranges::upper_bound(flight.times, time);
  if (next == flight.times.begin()) return flight.positions.front();
  if (next == flight.times.end()) return flight.positions.back();
  const auto i = static_cast<std::size_t>(next - flight.times.begin());
  const double s = (time - flight.times[i - 1]) / (flight.times[i] - flight.times[i - 1]);
  return (1 - s) * flight.positions[i - 1] + s * flight.positions[i];
}

double last_arrival(const std::vector<Flight>& flights) {
  double last = 0;
  for (const Flight& flight : flights) last = std::max(last, flight.times.back());
  return last;
}

}  // namespace nuno::figures
