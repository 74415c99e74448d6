#include "pictures/flight_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <nuno/crossings.h>
#include "pictures/sheet_shading.h"

namespace nuno::figures {
namespace {

constexpr double width = 800;
constexpr double ghost_opacity = 0.35, target_opacity = 0.7, initial_opacity = 0.75,
                 over_another = 0.7;
constexpr double margin = 0.06;  // of the data, around it

struct Extent {
  double left = std::numeric_limits<double>::infinity(), right = -left;
  double bottom = left, top = -left;
  bool in_space = false;

  void add(const Points& shape) {
    in_space = in_space || shape.rows() == 3;
    const Points points = seen(shape);
    left = std::min(left, points.row(0).minCoeff());
    right = std::max(right, points.row(0).maxCoeff());
    bottom = std::min(bottom, points.row(1).minCoeff());
    top = std::max(top, points.row(1).maxCoeff());
  }
  Extent grown() const {
    const double by = margin * std::max({right - left, top - bottom, 1e-9});
    Extent result = *this;
    result.left -= by, result.right += by, result.bottom -= by, result.top += by;
    return result;
  }
  double aspect() const { return (top - bottom) / (right - left); }
  Axis x() const { return {in_space ? "across [m]" : "x [m]", left, right}; }
  Axis y() const { return {in_space ? "up [m]" : "y [m]", bottom, top}; }
};

bool is_sheet(const Flight& flight) { return !flight.faces.empty(); }

/// Where the particles are on the plot.
std::vector<Vec> mapped(const Plot& plot, const Points& points) {
  const Points on_paper = seen(points);
  std::vector<Vec> result;
  for (const auto point : on_paper.colwise()) result.push_back(plot.at(point.x(), point.y()));
  return result;
}

/// The cloth's line on the plot.
std::vector<Vec> line_of(const Plot& plot, const Flight& flight, const Points& pose) {
  const std::vector<Vec> places = mapped(plot, pose);
  std::vector<Vec> line;
  for (const Index i : flight.stroke) line.push_back(places[static_cast<std::size_t>(i)]);
  return line;
}

double ground_of(const Flight& flight) {
  return ground_height(flight.positions.front(), flight.target);
}

Extent extent_of(const std::vector<Flight>& flights) {
  Extent extent;
  for (const Flight& flight : flights) {
    extent.add(flight.target);
    for (const Points& positions : flight.positions) {
      extent.add(positions);
      if (is_sheet(flight)) extent.add(shadow_of(positions, ground_of(flight)));
    }
  }
  return extent.grown();
}

/// One pose of a cloth: a sheet's faces, a chain's line in these styles.
void draw_pose(Drawing& drawing, const Plot& plot, const Flight& flight, const Points& pose,
               const Paint& paint, const std::string& styles) {
  if (is_sheet(flight)) {
    drawing.raw(shaded(plot, flight.faces, pose, paint));
  } else {
    drawing.line(line_of(plot, flight, pose), styles);
  }
}

void draw_shadow(Drawing& drawing, const Plot& plot, const Flight& flight, const Points& pose) {
  if (is_sheet(flight)) {
    drawing.raw(soft_shadow(plot, flight.faces, pose, ground_of(flight)));
  }
}

std::vector<Vec> centroid_path(const Plot& plot, const Flight& flight) {
  std::vector<Vec> path;
  for (const Points& positions : flight.positions) {
    path.push_back(mapped(plot, centroid(positions)).front());
  }
  return path;
}

/// Whether two flights have one target: it is then drawn and named once.
bool same_target(const Flight& a, const Flight& b) {
  return a.target.cols() == b.target.cols() && a.target.isApprox(b.target, 1e-9);
}

bool same_initial(const Flight& a, const Flight& b) {
  return a.positions[0].cols() == b.positions[0].cols() &&
         a.positions[0].isApprox(b.positions[0], 1e-9);
}

/// Without a legend there is nothing to tell apart.
std::size_t dashed(const std::vector<Flight>& flights, const FlightFigure& options) {
  return options.plain ? 1 : flights.size();
}

std::string_view final_width(const FlightFigure& options) {
  return options.plain ? "bold" : "thick";
}

/// A mesh is drawn by many lines: thin ones.
std::string_view weight(const Flight& flight, std::string_view of_chain) {
  return is_sheet(flight) ? "thin" : of_chain;
}

std::string style_of(std::size_t i, std::size_t count, std::string_view more) {
  // One flight is the drawing's subject, not a series of it; later ones lie on those before.
  constexpr std::array<std::string_view, 4> dashes = {"", "dashes", "long", "short"};
  return fmt::format("{} {} {}", series(i), count > 1 ? dashes[i % 4] : "", more);
}

/// Title and subtitle; where the frame can begin.
double draw_title(Drawing& drawing, const FlightFigure& options, const std::vector<Flight>& flights,
                  bool legend) {
  drawing.text({16, 26}, options.title, Anchor::start, "title");
  drawing.text({16, 45}, options.subtitle, Anchor::start, "muted");
  double y = 45;
  if (legend && flights.size() > 1) {
    double x = 16;
    y += 21;
    for (std::size_t i = 0; i < flights.size(); ++i) {
      const std::string name = fmt::format("{}, {}, α = {} N/m, error {:.3g} %", flights[i].scene,
                                           engine_name(flights[i].backend), shown(flights[i].gain),
                                           100 * flights[i].error / flights[i].cloth_length);
      const double wide = 44 + 7.2 * static_cast<double>(name.size());
      if (x > 16 && x + wide > width) {
        x = 16;
        y += 18;
      }
      drawing.line({x, y - 4}, {x + 24, y - 4}, style_of(i, flights.size(), "thick"));
      drawing.text({x + 31, y}, name, Anchor::start);
      x += wide;
    }
  }
  return y + 17;
}

struct Layout {
  Vec size;
  Box main;
};

Layout layout_of(const Extent& extent, double top, double main_width, bool plain) {
  if (plain) {
    const double height = std::clamp(width * extent.aspect(), 160.0, 800.0);
    return {{width, height}, {0, 0, width, height}};
  }
  const double height = std::clamp(main_width * extent.aspect(), 230.0, 520.0);
  return {{width, top + height + 46}, {58, top, main_width, height}};
}

void draw_ghosts(Drawing& drawing, const Plot& plot, const std::vector<Flight>& flights,
                 const FlightFigure& options) {
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const Flight& flight = flights[i];
    for (int k = 1; k <= options.ghosts; ++k) {
      const double time = flight.times.back() * k / (options.ghosts + 1);
      const Points pose = positions_at(flight, time);
      draw_pose(drawing, plot, flight, pose, {series(i), ghost_opacity},
                style_of(i, dashed(flights, options), "ghost"));
      if (options.plain) continue;
      const Vec at = mapped(plot, centroid(pose)).front();
      drawing.marker(Marker::circle, at, 4, "soft", Weight::light);
      if (i == 0 && flights.size() == 1) {
        const Vec end = mapped(plot, pose.rightCols(1)).front();
        drawing.label(end, fmt::format("{:.2f} s", time), "muted", plot.frame());
      }
    }
  }
}

void draw_targets(Drawing& drawing, const Plot& plot, const std::vector<Flight>& flights) {
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (i > 0 && same_target(flights[i - 1], flights[i])) continue;
    draw_pose(drawing, plot, flights[i], flights[i].target, {"target", target_opacity}, "band");
  }
}

void draw_particles(Drawing& drawing, const Plot& plot, const Points& pose, std::size_t i) {
  if (pose.rows() == 3) return;  // a mesh shows them by itself
  const std::vector<Vec> places = mapped(plot, pose);
  double apart = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < places.size(); ++k) {
    apart =
        std::min(apart, std::hypot(places[k].x - places[k - 1].x, places[k].y - places[k - 1].y));
  }
  if (apart < 4) return;  // dots that touch say nothing
  for (const Vec& place : places) {
    drawing.marker(series_marker(i), place, std::clamp(apart, 4.0, 5.0), series(i), Weight::light);
  }
}

/// The arrival, enlarged: how far each particle is from its own place on the target.
void draw_arrival(Drawing& drawing, const Box& frame, const std::vector<Flight>& flights) {
  Extent extent;
  for (const Flight& flight : flights) {
    extent.add(flight.target);
    extent.add(flight.positions.back());
  }
  extent = extent.grown();
  const Plot plot = Plot::with_equal_scales(frame, extent.x(), extent.y());
  drawing.text({frame.left, frame.top - 8}, "At arrival, enlarged", Anchor::start, "strong");
  plot.draw_axes(drawing);
  for (const Flight& flight : flights) {
    drawing.line(line_of(plot, flight, flight.target), is_sheet(flight) ? "band mesh" : "band");
  }
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const Points& final = flights[i].positions.back();
    const std::vector<Vec> places = mapped(plot, final);
    const std::vector<Vec> wanted = mapped(plot, flights[i].target);
    for (std::size_t k = 0; k < places.size(); ++k) {
      drawing.line(places[k], wanted[k], "hair", Weight::none);
    }
    drawing.line(line_of(plot, flights[i], final),
                 style_of(i, flights.size(), weight(flights[i], "thick")));
    if (flights.size() > 1) continue;  // the dots of one would hide the other
    draw_particles(drawing, plot, final, i);
    Index worst = 0;
    (final - flights[i].target).colwise().squaredNorm().maxCoeff(&worst);
    drawing.label(places[static_cast<std::size_t>(worst)],
                  fmt::format("worst particle: {:.2g} % of L",
                              100 * flights[i].max_error / flights[i].cloth_length),
                  "", frame);
    const std::size_t middle = places.size() / 3;
    drawing.label(wanted[middle], "target", "muted", frame);
    drawing.label(places[2 * places.size() / 3], "final", "strong", frame);
  }
}

}  // namespace

std::string_view series(std::size_t i) {
  constexpr std::array<std::string_view, 4> names = {"a", "b", "c", "d"};
  return names[i % 4];
}

Marker series_marker(std::size_t i) {
  constexpr std::array<Marker, 4> markers = {Marker::circle, Marker::square, Marker::triangle,
                                             Marker::diamond};
  return markers[i % 4];
}

FlightFigure captioned(const std::vector<Flight>& flights, bool plain) {
  FlightFigure figure;
  figure.plain = plain;
  if (plain) figure.ghosts = 3;
  const Flight& first = flights.front();
  if (flights.size() == 1) {
    figure.title = first.scene;
    figure.subtitle = fmt::format(
        "{}, {} particles, α = {} N/m: mean error {:.3g} % of the cloth’s {}",
        engine_name(first.backend), first.target.cols(), shown(first.gain),
        100 * first.error / first.cloth_length, first.target.rows() == 3 ? "size" : "length");
  } else {
    const bool one_scene = std::ranges::all_of(
        flights, [&](const Flight& flight) { return flight.scene == first.scene; });
    figure.title = one_scene ? first.scene : fmt::format("{} throws", flights.size());
    figure.subtitle = "target: the broad line; errors in % of the cloth’s length";
  }
  return figure;
}

Drawing draw_flights(const std::vector<Flight>& flights, const FlightFigure& options) {
  const Extent extent = extent_of(flights);
  Drawing heading({0, 0}, "");
  const double top = draw_title(heading, options, flights, true) + (options.plain ? 0 : 14);
  constexpr double main_width = 432, enlarged = 224;
  const auto [size, frame] = layout_of(extent, top, main_width, options.plain);
  Drawing drawing(size, options.title + ". " + options.subtitle);
  const Plot plot = Plot::with_equal_scales(frame, extent.x(), extent.y());
  if (!options.plain) {
    draw_title(drawing, options, flights, true);
    plot.draw_axes(drawing);
  }
  for (const Flight& flight : flights) draw_shadow(drawing, plot, flight, flight.positions.back());
  draw_targets(drawing, plot, flights);
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (i > 0 && same_initial(flights[i - 1], flights[i])) continue;
    draw_pose(drawing, plot, flights[i], flights[i].positions.front(), {"soft", initial_opacity},
              "soft thick");
  }
  if (!options.plain) {
    for (const Flight& flight : flights) drawing.line(centroid_path(plot, flight), "soft dots");
  }
  draw_ghosts(drawing, plot, flights, options);
  for (std::size_t i = 0; i < flights.size(); ++i) {
    draw_pose(drawing, plot, flights[i], flights[i].positions.back(),
              {series(i), i == 0 ? 1 : over_another},
              style_of(i, dashed(flights, options), final_width(options)));
  }
  if (options.plain) return drawing;

  const Flight& first = flights.front();
  const auto place = [&](const Points& points, Index i) {
    return mapped(plot, points.col(i)).front();
  };
  const Index middle = first.target.cols() / 2;
  drawing.label(place(first.positions.front(), middle), "initial", "strong", frame);
  drawing.label(place(first.positions.back(), middle),
                flights.size() > 1 ? fmt::format("arrival, {} s", shown(first.times.back()))
                                   : fmt::format("final, {} s", shown(first.times.back())),
                "strong", frame);
  drawing.label(place(first.target, 0), "target", "muted", frame);
  const std::vector<Vec> path = centroid_path(plot, first);
  drawing.label(path[path.size() / 4], "centroid’s path", "muted", frame);
  draw_arrival(drawing, {width - enlarged - 16, frame.top, enlarged, frame.height}, flights);
  return drawing;
}

namespace {

/// Axes and targets of a film; the flights are still to be drawn on `plot`.
struct Stage {
  Drawing drawing;
  Plot plot;
};

Stage make_stage(const std::vector<Flight>& flights, const FlightFigure& options) {
  const Extent extent = extent_of(flights);
  Drawing heading({0, 0}, "");
  const double top = draw_title(heading, options, flights, true);
  auto [size, frame] = layout_of(extent, top, width - 74, options.plain);
  size.y = 2 * std::round(size.y / 2);  // films need even sizes
  Stage stage{Drawing(size, options.title + ". " + options.subtitle),
              Plot::with_equal_scales(frame, extent.x(), extent.y())};
  if (!options.plain) {
    draw_title(stage.drawing, options, flights, true);
    stage.plot.draw_axes(stage.drawing);
  }
  draw_targets(stage.drawing, stage.plot, flights);
  for (const Flight& flight : flights) {
    if (!options.plain) {
      stage.drawing.line(centroid_path(stage.plot, flight), "soft dots", Weight::light);
    }
    if (is_sheet(flight)) {
      stage.drawing.raw(shaded(stage.plot, flight.faces, flight.positions.front(), {"soft", 0.5}));
    } else {
      stage.drawing.line(line_of(stage.plot, flight, flight.positions.front()), "soft thin",
                         Weight::light);
    }
  }
  return stage;
}

std::string clock(double time, bool arrived) {
  return arrived ? fmt::format("t = {:.2f} s, arrival", time) : fmt::format("t = {:.2f} s", time);
}

}  // namespace

Drawing draw_moment(const std::vector<Flight>& flights, double time, const FlightFigure& options) {
  auto [drawing, plot] = make_stage(flights, options);
  const double end = last_arrival(flights);
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const Points pose = positions_at(flights[i], time);
    draw_shadow(drawing, plot, flights[i], pose);
    draw_pose(drawing, plot, flights[i], pose, {series(i), i == 0 ? 1 : over_another},
              style_of(i, dashed(flights, options), final_width(options)));
    if (!options.plain && flights.size() == 1) draw_particles(drawing, plot, pose, i);
  }
  if (!options.plain) {
    const Box& frame = plot.frame();
    drawing.text({frame.right(), frame.top - 6}, clock(std::min(time, end), time >= end),
                 Anchor::end, "strong");
  }
  return drawing;
}

Drawing draw_motion(const std::vector<Flight>& flights, double speed, const FlightFigure& options) {
  auto [drawing, plot] = make_stage(flights, options);
  if (options.plain) draw_ghosts(drawing, plot, flights, options);
  const double end = last_arrival(flights);
  const double cycle = end / speed + rest_at_arrival;
  constexpr double frames_per_second = 30;
  const int frames = std::clamp(static_cast<int>(end / speed * frames_per_second), 2, 600);
  std::string key_times = "0";
  for (int k = 1; k <= frames; ++k) {
    key_times += fmt::format(";{:.5g}", end / speed * k / frames / cycle);
  }
  key_times += ";1";
  for (std::size_t i = 0; i < flights.size(); ++i) {
    std::string values;
    std::string last;
    for (int k = 0; k <= frames; ++k) {
      std::vector<Vec> pose = line_of(plot, flights[i], positions_at(flights[i], end * k / frames));
      for (Vec& at : pose) at = {std::round(10 * at.x) / 10, std::round(10 * at.y) / 10};
      last = svg_points(pose);
      values += last + ";";
    }
    const std::string style =
        style_of(i, dashed(flights, options), weight(flights[i], final_width(options)));
    drawing.raw(fmt::format("<polyline class=\"line {} still\" points=\"{}\"/>\n", style, last));
    drawing.raw(fmt::format(
        "<polyline class=\"line {} moving\" points=\"{}\"><animate attributeName=\"points\" "
        "dur=\"{:.4g}s\" repeatCount=\"indefinite\" keyTimes=\"{}\" values=\"{}{}\"/></polyline>\n",
        style, last, cycle, key_times, values, last));
  }
  return drawing;
}

}  // namespace nuno::figures
