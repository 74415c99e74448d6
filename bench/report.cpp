#include "report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace nuno::bench {
namespace {

using Json = nlohmann::ordered_json;

bool is_known(const Statistics& value) { return std::isfinite(value.median); }

std::string number(double value) {
  if (std::isfinite(value) && value == std::round(value) && std::abs(value) < 1e6) {
    return fmt::format("{:.0f}", value);
  }
  return std::abs(value) < 1e-3 ? fmt::format("{:.1e}", value) : fmt::format("{:.3g}", value);
}

std::string cell(const Statistics& value) {
  if (!is_known(value)) return "–";
  if (value.min == value.max) return number(value.median);
  return fmt::format("{} ({}–{})", number(value.median), number(value.min), number(value.max));
}

/// Characters that a terminal shows; fmt pads by them too.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

std::size_t index_in(std::vector<std::string>& list, const std::string& text) {
  const auto found = std::ranges::find(list, text);
  if (found != list.end()) return static_cast<std::size_t>(found - list.begin());
  list.push_back(text);
  return list.size() - 1;
}

/// Text for a field of CSV.
std::string quoted(const std::string& text) {
  return text.find(',') == std::string::npos ? text : '"' + text + '"';
}

}  // namespace

void Report::begin(std::string section, std::string note) {
  section_ = std::move(section);
  fmt::print("\n== {}\n{}\n", section_, note);
  std::fflush(stdout);
}

void Report::check(bool holds, const std::string& what) {
  if (!holds) throw Refusal(fmt::format("{}: does not hold: {}", section_, what));
  fmt::print("  checked: {}\n", what);
  std::fflush(stdout);
  checks_.push_back(fmt::format("{}: {}", section_, what));
}

void Report::add(const std::string& name, const std::string& quantity, const std::string& unit,
                 const Statistics& value) {
  measurements_.push_back({section_, name, quantity, unit, value});
}

void Report::end() {
  std::vector<std::string> rows, columns;
  std::vector<std::vector<std::string>> cells;  // [row][column]
  for (const Measurement& m : measurements_) {
    if (m.section != section_) continue;
    const std::size_t row = index_in(rows, m.name);
    const std::size_t column =
        index_in(columns, m.unit.empty() ? m.quantity : fmt::format("{} [{}]", m.quantity, m.unit));
    cells.resize(rows.size());
    for (auto& line : cells) line.resize(columns.size(), "");
    cells[row][column] = cell(m.value);
  }
  std::size_t name_width = 0;
  for (const std::string& row : rows) name_width = std::max(name_width, width(row));
  const auto pad = [](const std::string& text, std::size_t to) {
    return std::string(to - std::min(to, width(text)), ' ');
  };
  fmt::print("  {}", std::string(name_width, ' '));
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    widths.push_back(width(columns[c]));
    for (const auto& line : cells) widths[c] = std::max(widths[c], width(line[c]));
    fmt::print("  {}{}", pad(columns[c], widths[c]), columns[c]);
  }
  fmt::print("\n");
  for (std::size_t r = 0; r < rows.size(); ++r) {
    fmt::print("  {}{}", rows[r], pad(rows[r], name_width));
    for (std::size_t c = 0; c < columns.size(); ++c) {
      fmt::print("  {}{}", pad(cells[r][c], widths[c]), cells[r][c]);
    }
    fmt::print("\n");
  }
  std::fflush(stdout);
}

void Report::add_ratio(std::string key, const Statistics& value) {
  ratios_.push_back({std::move(key), value});
}

void Report::print_ratios() const {
  fmt::print("\n== ratios: median (smallest–largest) over pairs of runs side by side\n");
  for (const Ratio& ratio : ratios_) fmt::print("  {:<34}{}\n", ratio.key, cell(ratio.value));
}

std::string Report::csv() const {
  std::string text =
      fmt::format("# cpu: {}\n# cores: {}\n# instruction set: {}\n# compiler: {}\n", machine_.cpu,
                  machine_.cores, machine_.instruction_set, machine_.compiler);
  text += "section,name,quantity,unit,median,min,max\n";
  const auto line = [&](const std::string& section, const std::string& name,
                        const std::string& quantity, const std::string& unit,
                        const Statistics& value) {
    if (!is_known(value)) return;
    text += fmt::format("{},{},{},{},{},{},{}\n", quoted(section), quoted(name), quoted(quantity),
                        quoted(unit), value.median, value.min, value.max);
  };
  for (const Measurement& m : measurements_) line(m.section, m.name, m.quantity, m.unit, m.value);
  for (const Ratio& ratio : ratios_) line("ratios", ratio.key, "ratio", "1", ratio.value);
  return text;
}

std::string Report::json() const {
  // NaN, "not known", becomes null.
  Json root;
  root["machine"] = {{"cpu", machine_.cpu},
                     {"cores", machine_.cores},
                     {"instruction_set", machine_.instruction_set},
                     {"compiler", machine_.compiler},
                     {"load", machine_.load}};
  for (const Ratio& ratio : ratios_) {
    root[ratio.key] = {{"value", ratio.value.median},
                       {"median", ratio.value.median},
                       {"min", ratio.value.min},
                       {"max", ratio.value.max}};
  }
  root["checks"] = checks_;
  root["measurements"] = Json::array();
  for (const Measurement& m : measurements_) {
    root["measurements"].push_back({{"section", m.section},
                                    {"name", m.name},
                                    {"quantity", m.quantity},
                                    {"unit", m.unit},
                                    {"median", m.value.median},
                                    {"min", m.value.min},
                                    {"max", m.value.max}});
  }
  return root.dump(2) + "\n";
}

}  // namespace nuno::bench
