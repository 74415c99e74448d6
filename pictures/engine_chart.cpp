#include "pictures/engine_chart.h"

#include <algorithm>

#include "pictures/flight_figure.h"

namespace nuno::figures {
namespace {

constexpr double strip = 40;        // from the numbers of y to the frame [px]
constexpr double for_numbers = 64;  // of y, with its title
constexpr double for_text = 48;     // below the frame

}  // namespace

Vec draw_heading(Drawing& drawing, const std::string& title, const std::string& subtitle,
                 std::span<const std::string> backends) {
  double y = 8;
  if (!title.empty()) {
    drawing.text({16, 26}, title, Anchor::start, "title");
    drawing.text({16, 45}, subtitle, Anchor::start, "muted");
    y = 50;
  }
  y += 16;
  double x = 16;
  for (std::size_t i = 0; i < backends.size(); ++i) {
    const std::string name = engine_name(backends[i]);
    drawing.line({x, y - 4}, {x + 26, y - 4}, engine_line(i));
    drawing.text({x + 33, y}, name, Anchor::start);
    x += 56 + 7.4 * static_cast<double>(name.size());
  }
  return {x, y};
}

std::string engine_line(std::size_t i) {
  return std::string(series(i)) + (i == 0 ? " thick" : " dashes");
}

double marker_size(std::size_t i, bool small) { return (i == 0 ? 10 : 6) + (small ? 0 : 1); }

std::string name_of_best(std::size_t i, std::span<const std::string> backends, bool same,
                         bool brief) {
  if (same && i > 0) return "";
  const std::string engine = engine_name(backends[i]);
  if (brief) return same ? "best" : engine + "’s best";
  return same ? "best, both engines" : "best, " + engine;
}

PlotWithZero::PlotWithZero(const Box& box, Axis x, Axis y)
    : plot_({box.left + for_numbers + strip, box.top, box.width - for_numbers - strip,
             box.height - for_text},
            std::move(x), std::move(y)),
      zero_(plot_.frame().left - strip + 8) {}

Vec PlotWithZero::at(double x, double y) const {
  Vec place = plot_.at(std::max(x, plot_.x().low), y);
  if (x <= 0) place.x = zero_;
  return place;
}

void PlotWithZero::draw_axes(Drawing& drawing) const {
  plot_.draw_axes(drawing, strip + 7);
  const Box& frame = plot_.frame();
  for (const Tick& tick : ticks(plot_.y(), static_cast<int>(frame.height / 40))) {
    if (tick.label.empty()) continue;
    const double height = plot_.at(plot_.x().low, tick.value).y;
    drawing.line({zero_ - 8, height}, {zero_ + 8, height}, "grid");
  }
  drawing.line({zero_ - 8, frame.bottom()}, {zero_ + 8, frame.bottom()}, "rule");
  drawing.text({zero_, frame.bottom() + 18}, "0", Anchor::middle, "muted");
}

}  // namespace nuno::figures
