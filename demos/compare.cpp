#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>

#include <nuno/comparison.h>
#include <nuno/conditioning.h>
#include <nuno/engines.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include <nuno/result_file.h>
#include "commands.h"
#include "pictures/report.h"
#include "pictures/summary.h"
#include "scene_paths.h"

namespace nuno {
namespace {

namespace fs = std::filesystem;

// Scene, engine, then what each engine achieved, then how far they are apart.
constexpr const char* table_row = "{:<{}.32}  {:<6}  {:>11}  {:>9}  {:>8}  {:>11}  {:>8}  {:>12}\n";

void print_heading(std::FILE* table, std::size_t width) {
  fmt::print(table, fmt::runtime(table_row), "scene", width, "engine", "launch only", "best α",
             "error", "evaluations", "time", "shapes apart");
  fmt::print(table, fmt::runtime(table_row), "", width, "", "% of L", "N/m", "% of L", "rollouts",
             "", "% of L");
}

void print_rows(std::FILE* table, std::size_t width, const Comparison& comparison) {
  const double percent = 100 / comparison.cloth_length;
  std::string scene = printable(comparison.scene);
  std::string apart = fmt::format("{:.3f}", 100 * comparison.shape_difference.mean);
  for (const ComparisonRow& row : comparison.rows) {
    fmt::print(table, fmt::runtime(table_row), scene, width, row.backend,
               fmt::format("{:.3f}", percent * row.launch_only_error),
               fmt::format("{:.4g}", row.gain), fmt::format("{:.3f}", percent * row.error.mean),
               row.evaluations, duration(row.seconds), apart);
    scene.clear();  // both stand for the two rows
    apart.clear();
  }
  const std::string off = centroid_warning(comparison);
  if (!off.empty()) fmt::print(table, "  {}\n", off);
  const auto most = std::ranges::max(comparison.rows, {}, &ComparisonRow::sensitivity);
  const std::string warning = fragility(most.sensitivity);
  if (!warning.empty()) fmt::print(table, "  {}\n", warning);
}

/// How far the engines agree over all scenes; nothing where no scene lets them be judged.
void print_summary(std::FILE* table, const ComparisonSummary& summary) {
  fmt::print(table,
             "{} of {} scenes are well-conditioned at native's best α: a change at the start grows "
             "at most {:g}-fold,\nno segment stretches by more than {:g} %.\n",
             summary.well_conditioned, summary.scenes, largest_calm_sensitivity,
             100 * largest_calm_strain);
  if (summary.judged == 0) return;
  const auto percents = [](const Spread& s) {
    return fmt::format("median {:.2g} %, 95th percentile {:.2g} %, worst {:.2g} %", 100 * s.median,
                       100 * s.most, 100 * s.worst);
  };
  fmt::print(table, "On the {} of them that are launched without stretching:\n", summary.judged);
  fmt::print(table, "  {:<26} {} (of L)\n", "shapes apart", percents(summary.gap));
  fmt::print(table, "  {:<26} {:.1f} % of {} gains within 2 % or 0.1 % of L\n",
             "same error at the same α", 100 * summary.curve_agreement, summary.curve_points);
  fmt::print(table, "  {:<26} {} (of the error)\n", "loss with the other's α",
             percents(summary.loss));
}

/// A scene's name as part of a file's.
std::string file_name(const std::string& scene) {
  std::string name;
  for (const char c : scene.substr(0, 80)) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_';
    name += plain ? c : '-';
  }
  return name;
}

void write_report(const std::string& folder, const std::vector<ReportScene>& scenes,
                  std::FILE* people) {
  const auto write = [&](const std::string& name, const std::string& text) {
    write_output(fs::path(folder) / name, text);
  };
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const std::string name =
        fmt::format("figures/{:02}-{}", i + 1, file_name(scenes[i].comparison.scene));
    write(name + "-gain.svg", gain_figure(scenes[i], 800, false));
    write(name + "-pareto-front.svg", pareto_figure(scenes[i], 800, false));
    if (scenes[i].choices.empty()) continue;
    const figures::FlightFigure figure{
        .title = scenes[i].comparison.scene,
        .subtitle = "each engine at its best gain; errors in % of the cloth’s length"};
    write(name + "-flight.svg",
          figures::draw_flights(scenes[i].choices.front().flights, figure).svg());
  }
  write("report.html", report_page(scenes));
  fmt::print(people, "The report, to be opened in a browser: {}\n",
             (fs::path(folder) / "report.html").string());
}

/// A scene on the two engines that fly it.
struct Pair {
  SceneFile file;
  std::unique_ptr<Backend> first, second;
};

/// Every scene is read and every engine made before the first of them runs: a mistake in the last
/// scene shows at once.
std::vector<Pair> make_pairs(const std::vector<std::string>& paths) {
  std::vector<Pair> pairs;
  for (const std::string& path : scene_paths(paths)) {
    SceneFile file = read_scene_file(path);
    const auto& [one, other] = engines_for(file.problem);
    auto first = make_backend(one, file);
    auto second = make_backend(other, file);
    pairs.push_back({std::move(file), std::move(first), std::move(second)});
  }
  return pairs;
}

/// Width of the table's first column.
std::size_t scene_column(const std::vector<Pair>& pairs) {
  std::size_t width = 5;
  for (const Pair& pair : pairs) {
    width = std::max(width, fmt::formatted_size("{:.32}", printable(pair.file.scene.name)));
  }
  return width;
}

/// Nothing where a flight diverged, which people are told.
std::optional<Comparison> compare_pair(const Pair& pair) {
  Comparison comparison = compare_engines(
      pair.file.scene.name, *pair.first, *pair.second,
      {.objective_of = [&](const Backend& backend) {
        return with_progress(objective(backend),
                             fmt::format("{} on {}", pair.file.scene.name, backend.name()));
      }});
  clear_progress();
  if (!comparison.divergence) return comparison;
  const auto& [backend, flight] = *comparison.divergence;
  report_divergence(pair.file.path, backend == pair.first->name() ? *pair.first : *pair.second,
                    flight);
  return std::nullopt;
}

}  // namespace

ExitStatus compare(const CompareOptions& options) {
  const std::vector<Pair> pairs = make_pairs(options.scenes);
  std::string out = options.out;
  const bool to_folder = !out.empty() && out != "-";
  if (to_folder) {
    create_folder((fs::path(out) / "figures").string());
    out = (fs::path(out) / "compare.json").string();
    require_writable(out);
  }

  std::FILE* const table = people(out);
  const std::size_t width = scene_column(pairs);
  std::vector<Comparison> comparisons;
  std::vector<ReportScene> report;
  print_heading(table, width);
  for (const Pair& pair : pairs) {
    std::optional<Comparison> comparison = compare_pair(pair);
    if (!comparison) continue;
    print_rows(table, width, *comparison);
    std::fflush(table);
    if (to_folder) report.push_back(make_report_scene(*comparison, *pair.first, *pair.second));
    comparisons.push_back(std::move(*comparison));
  }
  fmt::print(table,
             "L is the cloth's length, of a sheet √(rest area). Shapes apart: the end shapes of "
             "both engines at the best α "
             "of native,\ncentroids aligned, mean over the particles.\n");
  if (comparisons.size() > 1) print_summary(table, summarize(comparisons));
  // What is left of a comparison with diverged scenes is still one; without any, it is none.
  if (!out.empty() && !comparisons.empty()) {
    write_output(out, [&](std::FILE* file) { write_comparisons(file, comparisons); });
  }
  if (!report.empty()) write_report(options.out, report, table);
  return comparisons.size() == pairs.size() ? ExitStatus::done : ExitStatus::diverged;
}

}  // namespace nuno
