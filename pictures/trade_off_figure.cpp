#include "pictures/trade_off_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pictures/engine_chart.h"
#include "pictures/flight_figure.h"

namespace nuno::figures {
namespace {

/// The best trades that the figure has room for: not those that hardly differ from launch only.
std::vector<TradeOffPoint> shown_trades(const TradeOffCurve& curve) {
  std::vector<TradeOffPoint> trades = best_trades(curve.flights);
  const double launch_only = curve.flights.front().error;
  std::erase_if(trades, [&](const TradeOffPoint& point) {
    return point.gain <= 0 || point.error > 0.97 * launch_only;
  });
  return trades;
}

/// Whether no other flight's gain lies between two of them, the lower first.
bool are_neighbours(const std::vector<TradeOffPoint>& flights, double gain, double next) {
  const auto after = std::ranges::upper_bound(flights, gain, {}, &TradeOffPoint::gain);
  return after != flights.end() && after->gain == next;
}

}  // namespace

std::vector<TradeOffPoint> spread_along(const TradeOffCurve& curve, std::size_t count) {
  std::vector<TradeOffPoint> trades = shown_trades(curve);
  if (trades.size() <= count) return trades;
  const double wide = std::log(trades.back().effort / trades.front().effort);
  const double high = std::log(trades.front().error / trades.back().error);
  std::vector<double> along = {0};
  for (std::size_t i = 1; i < trades.size(); ++i) {
    along.push_back(along.back() +
                    std::hypot(std::log(trades[i].effort / trades[i - 1].effort) / wide,
                               std::log(trades[i - 1].error / trades[i].error) / high));
  }
  std::vector<TradeOffPoint> result;
  for (std::size_t i = 0, k = 0; k < count; ++k) {
    const double wanted = along.back() * static_cast<double>(k) / static_cast<double>(count - 1);
    while (i + 1 < along.size() && along[i] < wanted * (1 - 1e-12)) ++i;
    if (result.empty() || result.back().gain != trades[i].gain) result.push_back(trades[i]);
  }
  return result;
}

Drawing draw_trade_off(const std::vector<TradeOffCurve>& curves, double cloth_length,
                       const TradeOffFigure& options) {
  const double percent = 100 / cloth_length;
  const bool small = options.width < 600;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double low = infinity, high = 0, least = infinity, launch_only = 0;
  std::vector<std::string> backends;
  for (const TradeOffCurve& curve : curves) {
    backends.push_back(curve.backend);
    launch_only = std::max(launch_only, curve.flights.front().error);
    for (const TradeOffPoint& point : shown_trades(curve)) {
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
  const auto at = [&](const TradeOffPoint& point) {
    return plot.at(point.effort, std::max(percent * point.error, errors.low));
  };
  const auto ring = [&](std::size_t i, const TradeOffPoint& point) {
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
    for (const TradeOffPoint& point : curves[i].flights) {
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
    const TradeOffPoint* last = nullptr;
    const std::vector<TradeOffPoint> trades = best_trades(curves[i].flights);
    for (const TradeOffPoint& point : trades) {
      if (point.gain <= 0) continue;
      // Between gains that are no neighbours more effort buys nothing: a stair, not a slope.
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
  const bool same = std::ranges::all_of(curves, [&](const TradeOffCurve& curve) {
    const TradeOffPoint& best = curves[0].best;
    return std::abs(curve.best.effort - best.effort) <= 0.02 * best.effort &&
           std::abs(curve.best.error - best.error) <= 0.002 * cloth_length;
  });
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const TradeOffPoint& best = curves[i].best;
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
