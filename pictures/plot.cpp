#include "pictures/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nuno::figures {
namespace {

std::string superscript(int exponent) {
  constexpr std::array<const char*, 10> digits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string result = exponent < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(exponent))) {
    result += digits[static_cast<std::size_t>(c - '0')];
  }
  return result;
}

std::string power_of_ten(int exponent) {
  if (exponent >= -3 && exponent <= 3) return fmt::format("{:g}", std::pow(10, exponent));
  return "10" + superscript(exponent);
}

std::string with_minus(std::string number) {
  if (number.starts_with("-")) number.replace(0, 1, "−");
  return number;
}

double fraction(const Axis& axis, double value) {
  if (axis.scale == Scale::logarithmic) {
    return std::log(value / axis.low) / std::log(axis.high / axis.low);
  }
  return (value - axis.low) / (axis.high - axis.low);
}

}  // namespace

std::vector<Tick> ticks(const Axis& axis, int count) {
  std::vector<Tick> result;
  if (axis.scale == Scale::logarithmic) {
    const int first = static_cast<int>(std::floor(std::log10(axis.low)));
    const int last = static_cast<int>(std::ceil(std::log10(axis.high)));
    const int every = std::max(1, (last - first + count) / (count + 1));
    // Within two decades their powers alone would be too few.
    const bool narrow = axis.high / axis.low < 60;
    for (int exponent = first; exponent <= last; ++exponent) {
      for (int digit = 1; digit <= 9; ++digit) {
        const double value = digit * std::pow(10, exponent);
        if (value < axis.low * (1 - 1e-9) || value > axis.high * (1 + 1e-9)) continue;
        const bool named =
            digit == 1 ? (exponent - first) % every == 0 : narrow && (digit == 2 || digit == 5);
        result.push_back({value, !named ? "" : digit == 1 ? power_of_ten(exponent) : shown(value)});
      }
    }
    return result;
  }
  const double range = axis.high - axis.low;
  const double rough = range / std::max(1, count);
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  const double step = decade * (rough / decade < 1.5   ? 1
                                : rough / decade < 3.5 ? 2
                                : rough / decade < 7.5 ? 5
                                                       : 10);
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  const double first = std::ceil(axis.low / step - 1e-9);
  for (int k = 0; k < 100; ++k) {  // first + k may round to first
    const double value = (first + k) * step;
    if (!(value <= axis.high + 1e-9 * range)) break;
    result.push_back({value, with_minus(fmt::format("{:.{}f}", value + 0.0, decimals))});
  }
  return result;
}

std::string shown(double value) {
  if (value == 0) return "0";
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  if (exponent < -4 || exponent > 4) {
    return with_minus(
        fmt::format("{:.2g}·10{}", value / std::pow(10, exponent), superscript(exponent)));
  }
  return with_minus(fmt::format("{:.3g}", value));
}

Vec Plot::at(double x, double y) const {
  return {frame_.left + fraction(x_, x) * frame_.width,
          frame_.bottom() - fraction(y_, y) * frame_.height};
}

void Plot::draw_axes(Drawing& drawing, double left) const {
  for (const Tick& tick : ticks(x_, static_cast<int>(frame_.width / 60))) {
    const double x = at(tick.value, y_.low).x;
    if (tick.label.empty()) {
      drawing.line({x, frame_.bottom()}, {x, frame_.bottom() + 3}, "hair");
      continue;
    }
    drawing.line({x, frame_.top}, {x, frame_.bottom() + 5}, "grid");
    drawing.text({x, frame_.bottom() + 18}, tick.label, Anchor::middle, "muted");
  }
  double widest = 25;  // of y's numbers
  for (const Tick& tick : ticks(y_, static_cast<int>(frame_.height / 40))) {
    const double y = at(x_.low, tick.value).y;
    if (tick.label.empty()) continue;
    widest = std::max(widest, text_width(tick.label));
    drawing.line({frame_.left, y}, {frame_.right(), y}, "grid");
    drawing.text({frame_.left - left, y + 4}, tick.label, Anchor::end, "muted");
  }
  drawing.line({frame_.left, frame_.bottom()}, {frame_.right(), frame_.bottom()}, "rule");
  drawing.text({frame_.left + frame_.width / 2, frame_.bottom() + 35}, x_.title, Anchor::middle);
  drawing.vertical_text({frame_.left - left - widest - 6, frame_.top + frame_.height / 2},
                        y_.title);
}

Plot Plot::with_equal_scales(const Box& frame, Axis x, Axis y) {
  const double scale = std::max((x.high - x.low) / frame.width, (y.high - y.low) / frame.height);
  const auto widen = [scale](Axis& axis, double pixels) {
    const double middle = (axis.low + axis.high) / 2;
    axis.low = middle - scale * pixels / 2;
    axis.high = middle + scale * pixels / 2;
  };
  widen(x, frame.width);
  widen(y, frame.height);
  return {frame, std::move(x), std::move(y)};
}

}  // namespace nuno::figures
