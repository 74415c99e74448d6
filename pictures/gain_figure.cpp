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

namespace {

/// What the axes show.
struct Range {
  double low, high;  ///< gains [N/m]
  double top;        ///< error [% of L]
};

Range shown_range(const std::vector<GainCurve>& curves, double percent) {
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
  return {low, high, 1.06 * percent * std::min(largest, 1.7 * launch_only)};
}

/// The plot being drawn, and how it shows what it is of.
struct Canvas {
  Drawing& drawing;
  const PlotWithZero& plot;
  double percent;  ///< of L, a metre
  double top;      ///< [% of L]
  bool small;

  Vec at(double gain, double error) const {
    return plot.at(gain, std::min(percent * error, 2 * top));
  }
  Box labels() const {
    const Box& frame = plot.frame();
    return {frame.left + 2, frame.top + 2, frame.width - 4, frame.height - 4};
  }
};

bool has_descent(const std::vector<GainCurve>& curves) {
  return std::ranges::any_of(curves, [](const GainCurve& curve) { return !curve.descent.empty(); });
}

/// The rest of the key, from `at` on.
void draw_key(Drawing& drawing, Vec at, bool with_descent, bool small) {
  drawing.marker(Marker::circle, {at.x + 4, at.y - 4}, 6, "a open", Weight::none);
  drawing.marker(Marker::square, {at.x + 14, at.y - 4}, 6, "b open", Weight::none);
  drawing.text({at.x + 23, at.y}, "local minimum", Anchor::start);
  at.x += 132;
  if (!with_descent) return;
  drawing.line({at.x, at.y - 4}, {at.x + 26, at.y - 4}, "soft short thin");
  drawing.marker(Marker::diamond, {at.x + 13, at.y - 4}, 6, "soft", Weight::none);
  drawing.text({at.x + 33, at.y}, small ? "descent" : "steepest descent, step by step",
               Anchor::start);
}

void draw_curve(const Canvas& canvas, const GainCurve& curve, std::size_t i) {
  std::vector<Vec> part;
  canvas.drawing.begin_clip(canvas.plot.frame());
  const auto end_part = [&] {
    canvas.drawing.line(part, engine_line(i), i == 0 ? Weight::heavy : Weight::light);
    part.clear();
  };
  for (const Evaluation& point : curve.curve) {
    if (std::isfinite(point.error)) {
      part.push_back(canvas.at(point.gain, point.error));
    } else {
      end_part();  // a rollout that diverged leaves a gap
    }
  }
  end_part();
  canvas.drawing.end_clip();
}

void draw_descent(const Canvas& canvas, const GainCurve& curve, std::size_t i) {
  if (curve.descent.empty()) return;
  std::vector<Vec> path;
  for (const Evaluation& step : curve.descent) path.push_back(canvas.at(step.gain, step.error));
  canvas.drawing.line(path, "soft short thin", Weight::light);
  for (const Vec& step : path) canvas.drawing.marker(Marker::diamond, step, 6, series(i));
}

void draw_minima(const Canvas& canvas, const GainCurve& curve, std::size_t i) {
  for (const Evaluation& minimum : local_minima(curve.curve)) {
    if (canvas.percent * minimum.error > canvas.top) continue;
    canvas.drawing.marker(series_marker(i), canvas.at(minimum.gain, minimum.error),
                          canvas.small ? 5 : 7, i == 0 ? "a open" : "b open");
  }
  canvas.drawing.marker(series_marker(i), canvas.at(0, curve.launch_only_error),
                        marker_size(i, canvas.small), series(i));
}

/// The best of each engine, ringed; both are named, unless they are one.
void draw_bests(const Canvas& canvas, const std::vector<GainCurve>& curves,
                const std::vector<std::string>& backends) {
  const bool small = canvas.small;
  const bool same = std::ranges::all_of(curves, [&](const GainCurve& curve) {
    const Evaluation& best = curves[0].best;
    return std::abs(curve.best.gain - best.gain) <= 0.02 * best.gain &&
           canvas.percent * std::abs(curve.best.error - best.error) <= 0.2;
  });
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const Evaluation& best = curves[i].best;
    const Vec place = canvas.at(best.gain, best.error);
    canvas.drawing.marker(series_marker(i), place, marker_size(i, small), series(i));
    canvas.drawing.marker(Marker::ring, place, (small ? 14.0 : 17.0) + 4 * static_cast<double>(i),
                          i == 0 ? "a" : "b");
    const std::string name = name_of_best(i, backends, same, small);
    if (name.empty()) continue;
    canvas.drawing.label(place,
                         small ? fmt::format("{}: {:.2g} %", name, canvas.percent * best.error)
                               : fmt::format("{}: α = {} N/m, error {:.2f} %", name,
                                             shown(best.gain), canvas.percent * best.error),
                         "strong", canvas.labels());
  }
}

void label_descent(const Canvas& canvas, const GainCurve& curve) {
  if (curve.descent.empty()) return;
  const Evaluation& end = curve.descent.back();
  const double error = canvas.percent * end.error;
  canvas.drawing.label(
      canvas.at(end.gain, end.error),
      canvas.small ? fmt::format("first valley: {:.2g} %", error)
                   : fmt::format("the descent ends in the first valley: α = {} N/m, {:.2f} %",
                                 shown(end.gain), error),
      "", canvas.labels());
}

/// What a script needs to place a gain: the frame and its range.
void draw_cursor(const Canvas& canvas, const Range& range) {
  const Box& frame = canvas.plot.frame();
  canvas.drawing.raw(fmt::format(
      "<g class=\"cursor\" data-left=\"{:.6g}\" data-right=\"{:.6g}\" data-zero=\"{:.6g}\" "
      "data-low=\"{}\" data-high=\"{}\"><line class=\"line thin\" x1=\"0\" x2=\"0\" "
      "y1=\"{:.6g}\" "
      "y2=\"{:.6g}\"/><path class=\"dot\" d=\"M0 {:.6g}l5 -8h-10z\"/></g>\n",
      frame.left, frame.right(), canvas.plot.zero(), range.low, range.high, frame.top,
      frame.bottom(), frame.top + 1));
}

}  // namespace

Drawing draw_gain_curves(const std::vector<GainCurve>& curves, double cloth_length,
                         const GainFigure& options) {
  const double percent = 100 / cloth_length;
  const bool small = options.width < 600;
  const Range range = shown_range(curves, percent);

  Drawing drawing({options.width, options.height}, options.title + ". " + options.subtitle);
  std::vector<std::string> backends;
  backends.reserve(curves.size());
  for (const GainCurve& curve : curves) backends.push_back(curve.backend);
  const Vec heading = draw_heading(drawing, options.title, options.subtitle, backends);
  draw_key(drawing, heading, has_descent(curves), small);

  const PlotWithZero plot({0, heading.y + 14, options.width - 18, options.height - heading.y - 14},
                          {"gain α [N/m]", range.low, range.high, Scale::logarithmic},
                          {"error at arrival [% of L]", 0, range.top, Scale::linear});
  plot.draw_axes(drawing);
  const Canvas canvas{drawing, plot, percent, range.top, small};
  for (std::size_t i = 0; i < curves.size(); ++i) draw_curve(canvas, curves[i], i);
  for (std::size_t i = 0; i < curves.size(); ++i) draw_descent(canvas, curves[i], i);
  for (std::size_t i = 0; i < curves.size(); ++i) draw_minima(canvas, curves[i], i);
  draw_bests(canvas, curves, backends);
  label_descent(canvas, curves[0]);
  if (!small) {
    drawing.label(canvas.at(0, curves[0].launch_only_error), "launch only", "", canvas.labels());
  }
  if (options.cursor) draw_cursor(canvas, range);
  return drawing;
}

}  // namespace nuno::figures
