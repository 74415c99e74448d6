#include "pictures/pareto_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pictures/engine_chart.h"
#include "pictures/flight_figure.h"

namespace nuno::figures {
namespace {

/// The best pareto that the figure has room for: not those that hardly differ from launch only.
std::vector<ParetoPoint> shown_pareto(const ParetoCurve& curve) {
  std::vector<ParetoPoint> pareto = pareto_optimal(curve.flights);
  const double launch_only = curve.flights.front().error;
  std::erase_if(pareto, [&](const ParetoPoint& point) {
    return point.gain <= 0 || point.error > 0.97 * launch_only;
  });
  return pareto;
}

/// Whether no other flight's gain lies between two of them, the lower first.
bool are_neighbours(const std::vector<ParetoPoint>& flights, double gain, double next) {
  const auto after = std::ranges::upper_bound(flights, gain, {}, &ParetoPoint::gain);
  return after != flights.end() && after->gain == next;
}

}  // namespace

std::vector<ParetoPoint> spread_along(const ParetoCurve& curve, std::size_t count) {
  std::vector<ParetoPoint> pareto = shown_pareto(curve);
  if (pareto.size() <= count) return pareto;
  const double wide = std::log(pareto.back().effort / pareto.front().effort);
  const double high = std::log(pareto.front().error / pareto.back().error);
  std::vector<double> along = {0};
  for (std::size_t i = 1; i < pareto.size(); ++i) {
    along.push_back(along.back() +
                    std::hypot(std::log(pareto[i].effort / pareto[i - 1].effort) / wide,
                               std::log(pareto[i - 1].error / pareto[i].error) / high));
  }
  std::vector<ParetoPoint> result;
  for (std::size_t i = 0, k = 0; k < count; ++k) {
    const double wanted = along.back() * static_cast<double>(k) / static_cast<double>(count - 1);
    while (i + 1 < along.size() && along[i] < wanted * (1 - 1e-12)) ++i;
    if (result.empty() || result.back().gain != pareto[i].gain) result.push_back(pareto[i]);
  }
  return result;
}

Drawing draw_pareto_front(const std::vector<ParetoCurve>& curves, double cloth_length,
                          const ParetoFigure& options) {
  const double percent = 100 / cloth_length;
  const bool small = options.width < 600;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double low = infinity, high = 0, least = infinity, launch_only = 0;
  std::vector<std::string> backends;
  for (const ParetoCurve& curve : curves) {
    backends.push_back(curve.backend);
    launch_only = std::max(launch_only, curve.flights.front().error);
    for (const ParetoPoint& point : shown_pareto(curve)) {
      low = std::min(low, point.effort);
      high = std::max(high, point.effort);
      least = std::min(least, point.error);
    }
  }
  if (!(low < infinity)) low = high = 1, least = launch_only;  // no gain is of any use
  // What costs far more and brings nothing is not worth the room, nor is an error of nothing.
  low /= 1.6, high *= 2;
  least = std::max(least, 1e-9 * cloth_length);
  const Axis errors = {"error at arrival [% of L]", percent * least / 1.5,
                       percent * std::max(launch_only, 2 * least) * 1.4, Scale::logarithmic};

  Drawing drawing({options.width, options.height}, options.title + ". " + options.subtitle);
  const auto [x, y] = draw_heading(drawing, options.title, options.subtitle, backends);
  drawing.line({x, y - 4}, {x + 26, y - 4}, "soft thin");
  drawing.text({x + 33, y}, small ? "all other gains" : "all other gains: beaten in both",
               Anchor::start);
  const PlotWithZero plot(
      {0, y + 14, options.width - 18, options.height - y - 14},
      {fmt::format("control effort [{}]", options.effort_unit), low, high, Scale::logarithmic},
      errors);
  plot.draw_axes(drawing);
  const auto at = [&](const ParetoPoint& point) {
    return plot.at(point.effort, std::max(percent * point.error, errors.low));
  };
  const auto ring = [&](std::size_t i, const ParetoPoint& point) {
    drawing.marker(series_marker(i), at(point), marker_size(i, small), series(i));
    drawing.marker(Marker::ring, at(point), (small ? 14.0 : 17.0) + 4 * static_cast<double>(i),
                   series(i));
  };

  drawing.begin_clip(plot.frame());
  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::vector<Vec> part;
    const auto end_part = [&] {
      drawing.line(part, i == 0 ? "a thin ghost" : "b thin ghost", Weight::light);
      part.clear();
    };
    for (const ParetoPoint& point : curves[i].flights) {
      if (point.gain > 0 && std::isfinite(point.error)) {
        part.push_back(at(point));
      } else {
        end_part();
      }
    }
    end_part();
  }
  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::vector<Vec> line;
    const ParetoPoint* last = nullptr;
    const std::vector<ParetoPoint> pareto = pareto_optimal(curves[i].flights);
    for (const ParetoPoint& point : pareto) {
      if (point.gain <= 0) continue;
      // Between gains that are no neighbours more effort buys nothing: a stair, not a derivative.
      if (last && !are_neighbours(curves[i].flights, last->gain, point.gain)) {
        line.push_back({at(point).x, line.back().y});
      }
      line.push_back(at(point));
      last = &point;
    }
    drawing.line(line, engine_line(i), i == 0 ? Weight::heavy : Weight::light);
  }
  drawing.end_clip();

  for (std::size_t i = 0; i < curves.size(); ++i) {
    drawing.marker(series_marker(i), at(curves[i].flights.front()), marker_size(i, small),
                   series(i));
    if (options.picks.empty()) ring(i, curves[i].best);
  }
  for (std::size_t k = 0; k < options.picks.size(); ++k) {
    if (!options.picks[k].has_dots) continue;
    drawing.raw(fmt::format("<g class=\"dots-of\" data-choice=\"{}\">\n", k));
    for (std::size_t i = 0; i < options.picks[k].places.size(); ++i) {
      drawing.marker(series_marker(i), at(options.picks[k].places[i]), marker_size(i, small),
                     std::string(series(i)) + " open");
    }
    drawing.raw("</g>\n");
  }
  for (std::size_t k = 0; k < options.picks.size(); ++k) {
    drawing.raw(
        fmt::format("<g class=\"rings-of{}\" data-choice=\"{}\">\n", k == 0 ? " on" : "", k));
    for (std::size_t i = 0; i < options.picks[k].places.size(); ++i) {
      ring(i, options.picks[k].places[i]);
    }
    drawing.raw("</g>\n");
  }

  const Box& frame = plot.frame();
  const Box labels = {frame.left + 2, frame.top + 2, frame.width - 4, frame.height - 4};
  const bool same = std::ranges::all_of(curves, [&](const ParetoCurve& curve) {
    const ParetoPoint& best = curves[0].best;
    return std::abs(curve.best.effort - best.effort) <= 0.02 * best.effort &&
           std::abs(curve.best.error - best.error) <= 0.002 * cloth_length;
  });
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const ParetoPoint& best = curves[i].best;
    const std::string name = name_of_best(i, backends, same, small);
    if (name.empty()) continue;
    drawing.label(at(best),
                  small ? fmt::format("{}: {:.2g} %", name, percent * best.error)
                        : fmt::format("{}: α = {} N/m, error {:.2g} % at effort {}", name,
                                      shown(best.gain), percent * best.error, shown(best.effort)),
                  "strong", labels);
  }
  if (!small) drawing.label(at(curves[0].flights.front()), "launch only", "", labels);
  return drawing;
}

}  // namespace nuno::figures
