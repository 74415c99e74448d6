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

namespace {

/// What the axes show.
struct Range {
  double low, high;           ///< control effort
  double least, launch_only;  ///< error [m]
};

Range shown_range(const std::vector<ParetoCurve>& curves, double cloth_length) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Range range{infinity, 0, infinity, 0};
  for (const ParetoCurve& curve : curves) {
    range.launch_only = std::max(range.launch_only, curve.flights.front().error);
    for (const ParetoPoint& point : shown_pareto(curve)) {
      range.low = std::min(range.low, point.effort);
      range.high = std::max(range.high, point.effort);
      range.least = std::min(range.least, point.error);
    }
  }
  if (!(range.low < infinity)) {  // no gain is of any use
    range.low = range.high = 1;
    range.least = range.launch_only;
  }
  // What costs far more and brings nothing is not worth the room, nor is an error of nothing.
  range.low /= 1.6;
  range.high *= 2;
  range.least = std::max(range.least, 1e-9 * cloth_length);
  return range;
}

/// The plot being drawn, and how it shows what it is of.
struct Canvas {
  Drawing& drawing;
  const PlotWithZero& plot;
  double percent;  ///< of L, a metre
  double lowest;   ///< error [% of L]
  bool small;

  Vec at(const ParetoPoint& point) const {
    return plot.at(point.effort, std::max(percent * point.error, lowest));
  }
  void mark(std::size_t i, const ParetoPoint& point, std::string_view style) const {
    drawing.marker(series_marker(i), at(point), marker_size(i, small), style);
  }
  void ring(std::size_t i, const ParetoPoint& point) const {
    mark(i, point, series(i));
    drawing.marker(Marker::ring, at(point), (small ? 14.0 : 17.0) + 4 * static_cast<double>(i),
                   series(i));
  }
};

/// Every gain's flight.
void draw_all_gains(const Canvas& canvas, const ParetoCurve& curve, std::size_t i) {
  std::vector<Vec> part;
  const auto end_part = [&] {
    canvas.drawing.line(part, i == 0 ? "a thin ghost" : "b thin ghost", Weight::light);
    part.clear();
  };
  for (const ParetoPoint& point : curve.flights) {
    if (point.gain > 0 && std::isfinite(point.error)) {
      part.push_back(canvas.at(point));
    } else {
      end_part();
    }
  }
  end_part();
}

void draw_front(const Canvas& canvas, const ParetoCurve& curve, std::size_t i) {
  std::vector<Vec> line;
  const ParetoPoint* last = nullptr;
  const std::vector<ParetoPoint> pareto = pareto_optimal(curve.flights);
  for (const ParetoPoint& point : pareto) {
    if (point.gain <= 0) continue;
    // Between gains that are no neighbours more effort buys nothing: a stair, not a derivative.
    if (last && !are_neighbours(curve.flights, last->gain, point.gain)) {
      line.push_back({canvas.at(point).x, line.back().y});
    }
    line.push_back(canvas.at(point));
    last = &point;
  }
  canvas.drawing.line(line, engine_line(i), i == 0 ? Weight::heavy : Weight::light);
}

/// What a reader of the report may choose.
void draw_picks(const Canvas& canvas, const ParetoFigure& options) {
  for (std::size_t k = 0; k < options.picks.size(); ++k) {
    if (!options.picks[k].has_dots) continue;
    canvas.drawing.raw(fmt::format("<g class=\"dots-of\" data-choice=\"{}\">\n", k));
    for (std::size_t i = 0; i < options.picks[k].places.size(); ++i) {
      canvas.mark(i, options.picks[k].places[i], std::string(series(i)) + " open");
    }
    canvas.drawing.raw("</g>\n");
  }
  for (std::size_t k = 0; k < options.picks.size(); ++k) {
    canvas.drawing.raw(
        fmt::format("<g class=\"rings-of{}\" data-choice=\"{}\">\n", k == 0 ? " on" : "", k));
    for (std::size_t i = 0; i < options.picks[k].places.size(); ++i) {
      canvas.ring(i, options.picks[k].places[i]);
    }
    canvas.drawing.raw("</g>\n");
  }
}

void draw_labels(const Canvas& canvas, const std::vector<ParetoCurve>& curves,
                 const std::vector<std::string>& backends) {
  const bool small = canvas.small;
  const Box& frame = canvas.plot.frame();
  const Box labels = {frame.left + 2, frame.top + 2, frame.width - 4, frame.height - 4};
  const bool same = std::ranges::all_of(curves, [&](const ParetoCurve& curve) {
    const ParetoPoint& best = curves[0].best;
    return std::abs(curve.best.effort - best.effort) <= 0.02 * best.effort &&
           canvas.percent * std::abs(curve.best.error - best.error) <= 0.2;
  });
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const ParetoPoint& best = curves[i].best;
    const std::string name = name_of_best(i, backends, same, small);
    if (name.empty()) continue;
    canvas.drawing.label(
        canvas.at(best),
        small ? fmt::format("{}: {:.2g} %", name, canvas.percent * best.error)
              : fmt::format("{}: α = {} N/m, error {:.2g} % at effort {}", name, shown(best.gain),
                            canvas.percent * best.error, shown(best.effort)),
        "strong", labels);
  }
  if (!small) canvas.drawing.label(canvas.at(curves[0].flights.front()), "launch only", "", labels);
}

}  // namespace

Drawing draw_pareto_front(const std::vector<ParetoCurve>& curves, double cloth_length,
                          const ParetoFigure& options) {
  const double percent = 100 / cloth_length;
  const bool small = options.width < 600;
  const Range range = shown_range(curves, cloth_length);
  const Axis errors = {"error at arrival [% of L]", percent * range.least / 1.5,
                       percent * std::max(range.launch_only, 2 * range.least) * 1.4,
                       Scale::logarithmic};
  std::vector<std::string> backends;
  backends.reserve(curves.size());
  for (const ParetoCurve& curve : curves) backends.push_back(curve.backend);

  Drawing drawing({options.width, options.height}, options.title + ". " + options.subtitle);
  const auto [x, y] = draw_heading(drawing, options.title, options.subtitle, backends);
  drawing.line({x, y - 4}, {x + 26, y - 4}, "soft thin");
  drawing.text({x + 33, y}, small ? "all other gains" : "all other gains: beaten in both",
               Anchor::start);
  const PlotWithZero plot({0, y + 14, options.width - 18, options.height - y - 14},
                          {fmt::format("control effort [{}]", options.effort_unit), range.low,
                           range.high, Scale::logarithmic},
                          errors);
  plot.draw_axes(drawing);

  const Canvas canvas{drawing, plot, percent, errors.low, small};
  drawing.begin_clip(plot.frame());
  for (std::size_t i = 0; i < curves.size(); ++i) draw_all_gains(canvas, curves[i], i);
  for (std::size_t i = 0; i < curves.size(); ++i) draw_front(canvas, curves[i], i);
  drawing.end_clip();
  for (std::size_t i = 0; i < curves.size(); ++i) {
    canvas.mark(i, curves[i].flights.front(), series(i));
    if (options.picks.empty()) canvas.ring(i, curves[i].best);
  }
  draw_picks(canvas, options);
  draw_labels(canvas, curves, backends);
  return drawing;
}

}  // namespace nuno::figures
