#include "batch_summary.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <nuno/batch.h>
#include <nuno/input.h>
#include <nuno/output.h>
#include <nuno/scene.h>
#include "formats/compact_json.h"
#include "pictures/drawing.h"
#include "pictures/drawn_result.h"
#include "pictures/flight_figure.h"

namespace nuno {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What the table shows of a result: a column's name, and where its value stands.
struct Column {
  const char* name;
  Json::json_pointer value;
};

const std::array<Column, 9>& columns() {
  static const std::array<Column, 9> all = {
      {{"alpha", "/alpha"_json_pointer},
       {"error", "/error/mean"_json_pointer},
       {"relative_error", "/error/relative"_json_pointer},
       {"max_error", "/error/max"_json_pointer},
       {"centroid_error", "/error/centroid"_json_pointer},
       {"control_effort", "/control_effort"_json_pointer},
       {"sensitivity", "/sensitivity"_json_pointer},
       {"steps", "/steps"_json_pointer},
       {"evaluations", "/optimization/evaluations"_json_pointer}}};
  return all;
}

Json head_of_result(const std::string& text, const std::string& path) {
  static const JsonForm form = {.wanted = {"nuno_result", "scene", "backend", "alpha", "error",
                                           "control_effort", "sensitivity", "steps",
                                           "optimization"}};
  return parse_compact(text, path, form);
}

struct Row {
  std::vector<std::string> cells;  ///< of the columns; none where there is no result
  std::string picture;             ///< an SVG
};

Row row_of(const Shot& shot) {
  Row row;
  if (!shot.has_result()) return row;
  const std::string text = read_input(shot.result);
  const Json head = head_of_result(text, shot.result);
  for (const Column& column : columns()) {
    const Json value = head.contains(column.value) ? head[column.value] : Json();
    row.cells.push_back(value.is_number() ? value.dump() : "");
  }
  const std::vector flights = {parse_result(text, shot.result)};
  row.picture = figures::draw_flights(flights, figures::captioned(flights, false)).svg();
  return row;
}

/// As RFC 4180 has it.
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::string state_word(const Shot& shot) {
  switch (shot.state) {
    case Shot::State::thrown:
    case Shot::State::kept:
      return "ok";
    case Shot::State::diverged:
      return "diverged";
    case Shot::State::unwritten:
      return "unwritten";
    default:
      return "broken";
  }
}

std::string csv(const std::vector<Shot>& shots, const std::vector<Row>& rows) {
  std::string text = "shot,status";
  for (const Column& column : columns()) text += fmt::format(",{}", column.name);
  text += ",reason\n";
  for (std::size_t i = 0; i < shots.size(); ++i) {
    text += csv_cell(printable(shots[i].scene)) + ',' + state_word(shots[i]);
    for (std::size_t k = 0; k < columns().size(); ++k) {
      text += ',' + (rows[i].cells.empty() ? "" : rows[i].cells[k]);
    }
    text += ',' + csv_cell(printable(shots[i].reason)) + '\n';
  }
  return text;
}

std::string picture_name(const Shot& shot) {
  return fs::path(shot.result).stem().string() + ".svg";
}

/// A path as a link holds it.
std::string link(const std::string& path) {
  std::string text;
  for (const char c : path) {
    const bool is_plain =
        std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.' || c == '/';
    text += is_plain ? std::string(1, c)
                     : fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
  }
  return text;
}

std::string page(const std::vector<Shot>& shots, const std::vector<Row>& rows) {
  std::string text =
      "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>nuno: a batch of "
      "throws</title>\n"
      "<style>\nbody { font: 15px/1.5 system-ui, sans-serif; margin: 2rem; }\n"
      "table { border-collapse: collapse; }\n"
      "td, th { padding: 0.2rem 0.8rem; text-align: right; border-bottom: 1px solid #8884; }\n"
      "td:first-child, th:first-child, td:last-child { text-align: left; }\n"
      "figure { display: inline-block; width: 24rem; margin: 1rem 1rem 0 0; }\n"
      "img { width: 100%; background: white; }\n</style>\n<h1>A batch of throws</h1>\n"
      "<p>Each cloth is thrown at the gain of least error at its arrival. The numbers to their "
      "last "
      "digit: <a href=\"summary.csv\">summary.csv</a>.</p>\n<table>\n<tr><th>shot<th>status"
      "<th>α, N/m<th>error, % of L<th>worst, m<th>effort<th>a change grows\n";
  std::string pictures;
  const auto number = [](const std::string& cell, double scale = 1) {
    return cell.empty() ? cell : fmt::format("{:.4g}", scale * std::stod(cell));
  };
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const std::string name = figures::xml_text(fs::path(shots[i].scene).stem().string());
    text += fmt::format("<tr><td>{}<td>{}", name, state_word(shots[i]));
    if (const auto& cells = rows[i].cells; cells.empty()) {
      text += fmt::format("<td colspan=\"5\">{}\n", figures::xml_text(shots[i].reason));
    } else {
      text +=
          fmt::format("<td>{}<td>{}<td>{}<td>{}<td>{}\n", number(cells[0]), number(cells[2], 100),
                      number(cells[3]), number(cells[5]), number(cells[6]));
      pictures +=
          fmt::format("<figure><img loading=\"lazy\" src=\"pictures/{}\" alt=\"{}\"></figure>\n",
                      link(picture_name(shots[i])), name);
    }
  }
  return text + "</table>\n" + pictures;
}

}  // namespace

bool is_result(const std::string& path, const std::string& backend) {
  try {
    const Json head = head_of_result(read_input(path), path);
    return head.contains("nuno_result") && head.contains("backend") && head["backend"] == backend;
  } catch (const InputError&) {
    return false;
  }
}

void write_batch_summary(const std::string& folder, const std::vector<Shot>& shots, Index jobs) {
  const fs::path out = folder, pictures = out / "pictures";
  create_folder(pictures.string());
  std::vector<Row> rows(shots.size());
  run_batch(std::ssize(shots), jobs, [&](Index number, const std::stop_token&) {
    const auto i = static_cast<std::size_t>(number);
    rows[i] = row_of(shots[i]);
    return [&, i] {
      if (rows[i].cells.empty()) return;
      write_output(pictures / picture_name(shots[i]), rows[i].picture);
      rows[i].picture = {};
    };
  });
  write_output(out / "summary.csv", csv(shots, rows));
  write_output(out / "report.html", page(shots, rows));
  fmt::print("{} and {}\n", (out / "summary.csv").string(), (out / "report.html").string());
}

}  // namespace nuno
