#include "pictures/gain_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pictures/engine_chart.h"
#include "pictures/flight_figure.h"

namespace nuno::figures {

std::vector<Evaluation> local_minima(const std::vector<Evaluation>& curve) {
  std::vector<Evaluation> result;
  for (std::size_t i = 1; i + 1 < curve.size(); ++i) {
    const auto& [x0, y0] = curve[i - 1];
    const auto& [x1, y1] = curve[i];
    const auto& [x2, y2] = curve[i + 1];
    if (!(y1 < y0 && y1 <= y2) || !std::isfinite(y0) || !std::isfinite(y2)) continue;
    // In log α: the parabola through three points.
    const double a = std::log(x1 / x0), b = std::log(x2 / x1);
    const double left = (y0 - y1) / a, right = (y2 - y1) / b;
    const double curvature = (left + right) / (a + b);
    const double derivative = (right * a - left * b) / (a + b);
    const double move = curvature > 0 ? std::clamp(-derivative / (2 * curvature), -a, b) : 0;
    result.push_back(
        {x1 * std::exp(move), std::max(0.0, y1 + move * (derivative + curvature * move))});
  }
  return result;
}

Drawing draw_gain_curves(const std::vector<GainCurve>& curves, double cloth_length,
                         const GainFigure& options) {
  const double percent = 100 / cloth_length;
  const bool small = options.width < 600;
  double low = curves[0].curve.front().gain, high = curves[0].curve.back().gain;
  double launch_only = 0, largest = 0;
  for (const GainCurve& curve : curves) {
    launch_only = std::max(launch_only, curve.launch_only_error);
    for (const Evaluation& point : curve.curve) {
      if (std::isfinite(point.error)) largest = std::max(largest, point.error);
      low = std::min(low, point.gain);
      high = std::max(high, point.gain);
    }
  }
  // Gains that do not change anything yet are not worth the room either, but for a start.
  double first = high;
  for (const GainCurve& curve : curves) {
    const auto changed = std::ranges::find_if(curve.curve, [&](const Evaluation& point) {
      return !(std::abs(point.error - curve.launch_only_error) <= 0.03 * curve.launch_only_error);
    });
    if (changed != curve.curve.end()) first = std::min(first, changed->gain);
  }
  low = std::max(low, first / 3);
  if (!(low < high / 10)) low = curves[0].curve.front().gain;
  // What is far worse than no control at all is not worth the room.
  const double top = 1.06 * percent * std::min(largest, 1.7 * launch_only);

  Drawing drawing({options.width, options.height}, options.title + ". " + options.subtitle);
  std::vector<std::string> backends;
  backends.reserve(curves.size());
  for (const GainCurve& curve : curves) backends.push_back(curve.backend);
  auto [x, y] = draw_heading(drawing, options.title, options.subtitle, backends);
  drawing.marker(Marker::circle, {x + 4, y - 4}, 6, "a open", Weight::none);
  drawing.marker(Marker::square, {x + 14, y - 4}, 6, "b open", Weight::none);
  drawing.text({x + 23, y}, "local minimum", Anchor::start);
  x += 132;
  const bool with_descent =
      std::ranges::any_of(curves, [](const GainCurve& curve) { return !curve.descent.empty(); });
  if (with_descent) {
    drawing.line({x, y - 4}, {x + 26, y - 4}, "soft short thin");
    drawing.marker(Marker::diamond, {x + 13, y - 4}, 6, "soft", Weight::none);
    drawing.text({x + 33, y}, small ? "descent" : "steepest descent, step by step", Anchor::start);
  }

  const PlotWithZero plot({0, y + 14, options.width - 18, options.height - y - 14},
                          {"gain α [N/m]", low, high, Scale::logarithmic},
                          {"error at arrival [% of L]", 0, top, Scale::linear});
  plot.draw_axes(drawing);
  const Box& frame = plot.frame();
  const auto at = [&](double gain, double error) {
    return plot.at(gain, std::min(percent * error, 2 * top));
  };

  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::vector<Vec> part;
    drawing.begin_clip(frame);
    const auto end_part = [&] {
      drawing.line(part, engine_line(i), i == 0 ? Weight::heavy : Weight::light);
      part.clear();
    };
    for (const Evaluation& point : curves[i].curve) {
      if (std::isfinite(point.error)) {
        part.push_back(at(point.gain, point.error));
      } else {
        end_part();  // a rollout that diverged leaves a gap
      }
    }
    end_part();
    drawing.end_clip();
  }
  for (std::size_t i = 0; i < curves.size(); ++i) {
    if (curves[i].descent.empty()) continue;
    std::vector<Vec> path;
    for (const Evaluation& step : curves[i].descent) path.push_back(at(step.gain, step.error));
    drawing.line(path, "soft short thin", Weight::light);
    for (const Vec& step : path) drawing.marker(Marker::diamond, step, 6, series(i));
  }
  for (std::size_t i = 0; i < curves.size(); ++i) {
    for (const Evaluation& minimum : local_minima(curves[i].curve)) {
      if (percent * minimum.error > top) continue;
      drawing.marker(series_marker(i), at(minimum.gain, minimum.error), small ? 5 : 7,
                     i == 0 ? "a open" : "b open");
    }
    drawing.marker(series_marker(i), at(0, curves[i].launch_only_error), marker_size(i, small),
                   series(i));
  }
  // The best of an engine, ringed; both are named, unless they are one.
  const bool same = std::ranges::all_of(curves, [&](const GainCurve& curve) {
    const Evaluation& best = curves[0].best;
    return std::abs(curve.best.gain - best.gain) <= 0.02 * best.gain &&
           std::abs(curve.best.error - best.error) <= 0.002 * cloth_length;
  });
  const Box labels = {frame.left + 2, frame.top + 2, frame.width - 4, frame.height - 4};
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const Evaluation& best = curves[i].best;
    const Vec place = at(best.gain, best.error);
    drawing.marker(series_marker(i), place, marker_size(i, small), series(i));
    drawing.marker(Marker::ring, place, (small ? 14.0 : 17.0) + 4 * static_cast<double>(i),
                   i == 0 ? "a" : "b");
    const std::string name = name_of_best(i, backends, same, small);
    if (name.empty()) continue;
    drawing.label(place,
                  small ? fmt::format("{}: {:.2g} %", name, percent * best.error)
                        : fmt::format("{}: α = {} N/m, error {:.2f} %", name, shown(best.gain),
                                      percent * best.error),
                  "strong", labels);
  }
  if (with_descent && !curves[0].descent.empty()) {
    const Evaluation& end = curves[0].descent.back();
    drawing.label(at(end.gain, end.error),
                  small ? fmt::format("first valley: {:.2g} %", percent * end.error)
                        : fmt::format("the descent ends in the first valley: α = {} N/m, {:.2f} %",
                                      shown(end.gain), percent * end.error),
                  "", labels);
  }
  if (!small) {
    drawing.label(at(0, curves[0].launch_only_error), "launch only", "", labels);
  }
  if (options.cursor) {
    // What a script needs to place a gain: the frame and its range.
    drawing.raw(fmt::format(
        "<g class=\"cursor\" data-left=\"{:.6g}\" data-right=\"{:.6g}\" data-zero=\"{:.6g}\" "
        "data-low=\"{}\" data-high=\"{}\"><line class=\"line thin\" x1=\"0\" x2=\"0\" "
        "y1=\"{:.6g}\" "
        "y2=\"{:.6g}\"/><path class=\"dot\" d=\"M0 {:.6g}l5 -8h-10z\"/></g>\n",
        frame.left, frame.right(), plot.zero(), low, high, frame.top, frame.bottom(),
        frame.top + 1));
  }
  return drawing;
}

}  // namespace nuno::figures
