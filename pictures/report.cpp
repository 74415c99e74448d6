#include "pictures/report.h"

#include <fmt/format.h>

#include <nuno/crossings.h>
#include <nuno/optimize.h>
#include <nuno/parallel.h>
#include <nuno/scene_file.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include <nuno/conditioning.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include "embedded/report_css.h"
#include "embedded/report_html.h"
#include "embedded/report_js.h"
#include "embedded/report_sheet_js.h"
#include "pictures/gain_figure.h"
#include "pictures/pareto_figure.h"
#include "pictures/summary.h"

namespace nuno {
namespace {

using namespace figures;
using Json = nlohmann::ordered_json;

// The page's size: what an eye can follow on a screen, and no more.
constexpr double most_frames = 60, most_frames_of_sheet = 30;
constexpr Index most_particles = 64;    // of a chain
constexpr double most_positions = 1e7;  // in memory, per flight
constexpr double position_unit = 1e-4;  // of L
constexpr std::size_t pareto_to_pick = 8, pareto_to_pick_of_sheet = 2;

double frames_per_second(const Problem& problem) {
  const double affordable =
      std::max(1.0, most_positions / static_cast<double>(problem.cloth().particles()));
  const double readable = problem.is_sheet() ? most_frames_of_sheet : most_frames;
  return std::min(readable, affordable) / problem.arrival_time;
}

/// Evenly chosen columns, the first and the last among them. A sheet stays as it is.
Points thinned(const Points& points) {
  if (points.rows() == 3) return points;
  const Index count = std::min(points.cols(), most_particles);
  Points result(points.rows(), count);
  for (Index i = 0; i < count; ++i) {
    result.col(i) = points.col(i * (points.cols() - 1) / std::max<Index>(1, count - 1));
  }
  return result;
}

Json rounded(const Points& points, double unit) {
  Json result = Json::array();
  for (Index i = 0; i < points.cols(); ++i) {
    for (Index k = 0; k < points.rows(); ++k) result.push_back(std::llround(points(k, i) / unit));
  }
  return result;
}

/// Frames as whole numbers, each the change of the change since the one before: a flight is smooth,
/// and small numbers are short.
Json packed(const Flight& flight, double unit) {
  Json result = Json::array();
  const auto size = static_cast<std::size_t>(flight.target.size());
  std::vector<long long> last(size, 0), last_change(size, 0);
  for (const Points& positions : flight.positions) {
    for (Index i = 0; i < positions.cols(); ++i) {
      for (Index k = 0; k < positions.rows(); ++k) {
        const auto at = static_cast<std::size_t>(positions.rows() * i + k);
        const long long value = std::llround(positions(k, i) / unit);
        const long long change = value - last[at];
        result.push_back(change - last_change[at]);
        last[at] = value;
        last_change[at] = change;
      }
    }
  }
  return result;
}

std::string text_of(const Json& json) {
  // "<" ends a script wherever it stands.
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

Json to_json(const ReportScene& scene) {
  const Flight& first = scene.choices[0].flights[0];
  const double unit = position_unit * first.cloth_length;
  Json choices = Json::array();
  for (const ReportChoice& choice : scene.choices) {
    Json gains = Json::array(), errors = Json::array(), frames = Json::array(),
         readings = Json::array();
    for (std::size_t i = 0; i < choice.flights.size(); ++i) {
      const Flight& flight = choice.flights[i];
      gains.push_back(flight.gain);
      errors.push_back(flight.error / flight.cloth_length);
      frames.push_back(packed(flight, unit));
      readings.push_back({shown(flight.gain), shown(100 * flight.error / flight.cloth_length),
                          shown(choice.efforts[i])});
    }
    choices.push_back(
        {{"gains", gains}, {"errors", errors}, {"readings", readings}, {"frames", frames}});
  }
  Json times = Json::array();
  for (const double time : first.times) times.push_back(std::round(1e6 * time) / 1e6);
  Json json = {{"name", scene.comparison.scene},
               {"particles", first.target.cols()},
               {"dimension", first.target.rows()},
               {"stroke", first.stroke},
               {"length", first.cloth_length},
               {"unit", unit},
               {"times", times},
               {"target", rounded(first.target, unit)},
               {"choices", choices}};
  if (!first.faces.empty()) {
    json["faces"] = first.faces;
    json["ground"] = ground_height(first.positions.front(), first.target);
  }
  return json;
}

std::string key(std::size_t engine) {
  return fmt::format("<span class=\"key {}\"></span>", series(engine));
}

/// With so many decimals, and small numbers with two digits, which these decimals would hide.
std::string with_decimals(double value, int decimals) {
  const bool hidden = value > 0 && value < std::pow(10, 1 - decimals);
  return hidden ? fmt::format("{:.2g}", value) : fmt::format("{:.{}f}", value, decimals);
}

std::string table(const std::vector<ReportScene>& scenes) {
  std::string html =
      "<div class=\"wide\"><table>\n<thead><tr><th>scene</th><th class=\"engine\">engine</th>"
      "<th>launch only<small>% of L</small></th><th>best α<small>N/m</small></th>"
      "<th>error<small>% of L</small></th><th>worst particle<small>% of L</small></th>"
      "<th>at the other’s α<small>% of L</small></th><th>search<small>rollouts</small></th>"
      "<th>time<small>&nbsp;</small></th><th>shapes apart<small>% of L</small></th></tr></thead>\n"
      "<tbody>\n";
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const Comparison& comparison = scenes[s].comparison;
    const double percent = 100 / comparison.cloth_length;
    for (std::size_t i = 0; i < 2; ++i) {
      const ComparisonRow& row = comparison.rows[i];
      const bool better = row.error.mean < comparison.rows[1 - i].error.mean;
      html += fmt::format(
          "<tr class=\"{}\"><td class=\"name\">{}</td><td class=\"engine\">{}{}</td>"
          "<td>{:.2f}</td><td>{}</td><td class=\"{}\">{}</td><td>{}</td><td>{}</td>"
          "<td>{}</td><td>{}</td><td>{}</td></tr>\n",
          i == 0 ? "first" : "last",
          i == 0 ? fmt::format("<a href=\"#scene-{}\">{}</a>", s + 1, xml_text(comparison.scene))
                 : "",
          key(i), engine_name(row.backend), percent * row.launch_only_error, shown(row.gain),
          better ? "better" : "", with_decimals(percent * row.error.mean, 3),
          with_decimals(percent * row.error.max, 2),
          with_decimals(percent * row.error_with_the_other_gain, 3), row.evaluations,
          duration(row.seconds),
          i == 0 ? with_decimals(100 * comparison.shape_difference.mean, 3) : "");
    }
  }
  return html +
         "</tbody></table></div>\n<p class=\"note\">Bold: the smaller error of the two. Shapes "
         "apart: the end shapes of both engines at native’s best α, centroids aligned, mean over "
         "the particles.</p>\n";
}

/// The gains of the flights that a scene's section can show, to choose from.
std::string gain_choices(const ReportScene& scene, std::size_t number) {
  std::string gains;
  for (std::size_t i = 0; i < scene.choices.size(); ++i) {
    const ReportChoice& choice = scene.choices[i];
    gains +=
        fmt::format("<label{}><input type=\"radio\" name=\"gain-{}\" value=\"{}\"{}>{}</label>\n",
                    choice.is_pareto ? " class=\"pareto\"" : "", number, i,
                    i == 0 ? " checked" : "", xml_text(choice.label));
  }
  return gains;
}

/// A row for each engine, filled in on the page.
std::string readings(const Comparison& comparison) {
  std::string rows;
  for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
    rows += fmt::format(
        "<tr><td class=\"engine\">{}{}</td><td data-part=\"reading-{}-0\"></td>"
        "<td data-part=\"reading-{}-1\"></td><td data-part=\"reading-{}-2\"></td></tr>\n",
        key(i), engine_name(comparison.rows[i].backend), i, i, i);
  }
  return rows;
}

/// Where a sheet passes through itself or the ground, on either engine at its best gain.
std::string crossings_note(const ReportScene& scene) {
  std::string note;
  for (const Flight& flight : scene.choices[0].flights) {
    if (flight.faces.empty()) continue;
    const FlightCrossings crossings =
        flight_crossings(flight.times, flight.positions, flight.faces,
                         ground_height(flight.positions.front(), flight.target));
    note += fmt::format(" On {} it passes through {}.", engine_name(flight.backend),
                        crossing_words(crossings, flight.cloth_length));
  }
  return note;
}

std::string section(const ReportScene& scene, std::size_t number) {
  const Comparison& comparison = scene.comparison;
  return fmt::format(
      R"(<section class="scene" id="scene-{number}" aria-label="{name}">
<h2>{name}</h2>
<p class="note">{particles} particles, {time} s, L = {length} m.{crossings}</p>
<div class="panels">
<div>
<div class="legend"><span>{key_a}{engine_a}</span><span>{key_b}{engine_b}</span><span><span
class="key target"></span>target</span></div>
<div class="stage" data-part="stage"></div>
<div class="player">
<button type="button" data-part="play">Play</button>
<div class="scrub"><input type="range" min="0" max="1" step="any" value="1" data-part="time"
aria-label="Time"></div>
<select data-part="speed" aria-label="Speed"><option value="0.1">× 0.1</option><option
value="0.25">× 0.25</option><option value="0.5">× 0.5</option><option value="1" selected>×
1</option><option value="2">× 2</option></select>
</div>
<dl class="readings">
<div><dt>time</dt><dd data-part="clock"></dd></div>
<div><dt>{key_a}{engine_a}, <span data-part="what"></span></dt><dd data-part="error-0"></dd></div>
<div><dt>{key_b}{engine_b}, <span data-part="what-1"></span></dt><dd data-part="error-1"></dd></div>
<div><dt>engines apart</dt><dd data-part="apart-now"></dd></div>
</dl>
<fieldset class="gains" data-part="gains"><legend>Gain of the flights shown</legend>
{gains}</fieldset>
<h3 class="below">Engines apart on the way, mean [% of L]</h3>
<div data-part="apart"></div>
<button type="button" class="link" data-part="most"></button>
<p class="note print" data-part="most-print"></p>
</div>
<div>
<h3>Error at arrival, by gain</h3>
{figure}
<h3 class="below">Error at arrival, by control effort</h3>
<div data-part="pareto-front">
{pareto_front}</div>
<p class="note">Lines: the gains that no other beats in both. <span class="screen">Click a point to fly
it.</span></p>
<table class="pareto" aria-live="polite">
<thead><tr><th class="engine">flight shown</th><th>α<small>N/m</small></th><th>error<small>% of
L</small></th><th>effort<small>{unit}</small></th></tr></thead>
<tbody>
{readings}</tbody></table>
</div>
</div>
</section>
)",
      fmt::arg("number", number), fmt::arg("name", xml_text(comparison.scene)),
      fmt::arg("particles", scene.particles), fmt::arg("time", shown(scene.arrival_time)),
      fmt::arg("length", shown(comparison.cloth_length)), fmt::arg("key_a", key(0)),
      fmt::arg("key_b", key(1)), fmt::arg("engine_a", engine_name(comparison.rows[0].backend)),
      fmt::arg("engine_b", engine_name(comparison.rows[1].backend)),
      fmt::arg("crossings", crossings_note(scene)),
      fmt::arg("figure", gain_figure(scene, 440, true)),
      fmt::arg("gains", gain_choices(scene, number)),
      fmt::arg("pareto_front", pareto_figure(scene, 440, true)),
      fmt::arg("unit", xml_text(scene.effort_unit)), fmt::arg("readings", readings(comparison)));
}

/// What an engine's flights of a comparison paid for their errors.
ParetoCurve pareto_front_curve(const Comparison& comparison, std::size_t engine) {
  const ComparisonRow& row = comparison.rows[engine];
  const ParetoPoint best = {row.gain, row.error.mean, row.control_effort};
  ParetoCurve curve{.backend = row.backend, .flights = {best}, .best = best};
  for (std::size_t k = 0; k < comparison.curve_gains.size(); ++k) {
    curve.flights.push_back({comparison.curve_gains[k], comparison.curve_errors[engine][k],
                             comparison.curve_efforts[engine][k]});
  }
  std::ranges::sort(curve.flights, {}, &ParetoPoint::gain);
  return curve;
}

std::string subtitle(const ReportScene& scene) {
  return fmt::format("{}, {} particles, t₀ = {} s, both engines", scene.comparison.scene,
                     scene.particles, shown(scene.arrival_time));
}

std::string replaced(std::string_view page, std::string_view mark, const std::string& text) {
  std::string result(page);
  const std::size_t at = result.find(mark);
  return at == std::string::npos ? result : result.replace(at, mark.size(), text);
}

}  // namespace

ReportScene make_report_scene(const Comparison& comparison, const Backend& first,
                              const Backend& second) {
  const Problem& problem = first.problem();
  ReportScene scene{.comparison = comparison,
                    .particles = problem.cloth().particles(),
                    .arrival_time = problem.arrival_time,
                    .effort_unit = effort_unit_name(problem.cloth()),
                    .descent = {},
                    .choices = {}};
  struct Wish {
    std::string label;
    double first_gain = 0, second_gain = 0;
    bool is_pareto = false;
  };
  const double best = comparison.rows[0].gain, other_best = comparison.rows[1].gain;
  const auto differs = [&](double gain) { return std::abs(gain - best) > 0.01 * best; };
  std::vector<Wish> wishes = {{"each at its own best", best, other_best}};
  if (differs(other_best)) {
    wishes.push_back({fmt::format("both at native’s best, {}", shown(best)), best, best});
    wishes.push_back({fmt::format("both at {}’s best, {}", engine_name(comparison.rows[1].backend),
                                  shown(other_best)),
                      other_best, other_best});
  }
  const OptimizeSummary descent = steepest_descent(objective(first));
  scene.descent = descent.history;
  if (differs(descent.gain)) {
    wishes.push_back(
        {fmt::format("where descent ends, {}", shown(descent.gain)), descent.gain, descent.gain});
  }
  wishes.push_back({"launch only, 0", 0, 0});
  const std::size_t picks = problem.is_sheet() ? pareto_to_pick_of_sheet : pareto_to_pick;
  for (const ParetoPoint& point : spread_along(pareto_front_curve(comparison, 0), picks)) {
    if (!differs(point.gain)) continue;
    wishes.push_back(
        {fmt::format("α = {} N/m: error {} %, effort {}", shown(point.gain),
                     shown(100 * point.error / comparison.cloth_length), shown(point.effort)),
         point.gain, point.gain, true});
  }

  const RolloutOptions frames = {.frames_per_second = frames_per_second(problem)};
  for (const Wish& wish : wishes) {
    show_progress(fmt::format("{}: flight {} of {} for the report", comparison.scene,
                              &wish - wishes.data() + 1, wishes.size()));
    std::array<Rollout, 2> rollouts;
    parallel_for(2, [&](Index i) {
      rollouts[static_cast<std::size_t>(i)] = i == 0 ? rollout(first, wish.first_gain, frames)
                                                     : rollout(second, wish.second_gain, frames);
    });
    if (std::ranges::any_of(rollouts, diverged)) continue;
    ReportChoice choice{wish.label, wish.is_pareto, {}, {}};
    for (std::size_t i = 0; i < 2; ++i) {
      Flight flight = make_flight(comparison.scene, i == 0 ? first : second, rollouts[i]);
      flight.target = thinned(flight.target);
      for (Points& positions : flight.positions) positions = thinned(positions);
      // A chain's line goes from one of those left to the next.
      if (flight.target.rows() == 2) {
        flight.stroke.resize(static_cast<std::size_t>(flight.target.cols()));
      }
      choice.flights.push_back(std::move(flight));
      choice.efforts.push_back(rollouts[i].control_effort);
    }
    scene.choices.push_back(std::move(choice));
  }
  clear_progress();
  return scene;
}

std::string gain_figure(const ReportScene& scene, double width, bool for_page) {
  const Comparison& comparison = scene.comparison;
  std::vector<GainCurve> curves;
  for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
    const ComparisonRow& row = comparison.rows[i];
    GainCurve curve{.backend = row.backend,
                    .launch_only_error = row.launch_only_error,
                    .curve = {},
                    .descent = {},
                    .best = {row.gain, row.error.mean}};
    for (std::size_t k = 0; k < comparison.curve_gains.size(); ++k) {
      const double gain = comparison.curve_gains[k];
      if (gain > 0) curve.curve.push_back({gain, comparison.curve_errors[i][k]});
    }
    // The best is a point of the curve as well, between two of the scan.
    const auto next = std::ranges::upper_bound(curve.curve, row.gain, {}, &Evaluation::gain);
    if (row.gain > 0) curve.curve.insert(next, curve.best);
    if (i == 0) curve.descent = scene.descent;
    curves.push_back(std::move(curve));
  }
  GainFigure options;
  options.width = width;
  options.height = for_page ? 300 : 430;
  options.cursor = for_page;
  if (!for_page) {
    options.title = "Error at arrival against the gain of the shape control";
    options.subtitle = subtitle(scene);
  }
  return draw_gain_curves(curves, comparison.cloth_length, options).svg(!for_page);
}

std::string pareto_figure(const ReportScene& scene, double width, bool for_page) {
  const Comparison& comparison = scene.comparison;
  ParetoFigure options;
  options.width = width;
  options.height = for_page ? 300 : 430;
  options.effort_unit = scene.effort_unit;
  if (for_page) {
    for (const ReportChoice& choice : scene.choices) {
      ParetoPick pick{.places = {}, .has_dots = choice.is_pareto || options.picks.empty()};
      for (std::size_t i = 0; i < choice.flights.size(); ++i) {
        const Flight& flight = choice.flights[i];
        pick.places.push_back({flight.gain, flight.error, choice.efforts[i]});
      }
      options.picks.push_back(std::move(pick));
    }
  } else {
    options.title = "Error at arrival against control effort";
    options.subtitle = subtitle(scene);
  }
  return draw_pareto_front({pareto_front_curve(comparison, 0), pareto_front_curve(comparison, 1)},
                           comparison.cloth_length, options)
      .svg(!for_page);
}

std::string report_page(const std::vector<ReportScene>& scenes) {
  std::string sections;
  Json flights = Json::array();
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    sections += section(scenes[i], i + 1);
    flights.push_back(to_json(scenes[i]));
  }
  std::string page(embedded::report_html);
  page = replaced(page, "/*{style}*/", style_sheet() + "\n" + std::string(embedded::report_css));
  page = replaced(page, "<!--{table}-->", table(scenes));
  page = replaced(page, "<!--{scenes}-->", sections);
  page = replaced(page, "<!--{footer}-->",
                  "Made by nuno " NUNO_VERSION
                  ". The page is one file and needs no network. compare.json beside it holds the "
                  "numbers.");
  // The data last: a scene's name may hold anything.
  page = replaced(page, "/*{script}*/",
                  std::string(embedded::report_sheet_js) + std::string(embedded::report_js));
  return replaced(page, "/*{flights}*/", text_of(flights));
}

}  // namespace nuno
