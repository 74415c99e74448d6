// nuno figures: the paper's figures 5 to 8, from our own runs.

#include <fmt/format.h>

#include <filesystem>

#include <nuno/conditioning.h>
#include <nuno/engines.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include <nuno/scene_file.h>
#include "commands.h"
#include "embedded/s_curve_32_json.h"
#include "embedded/s_curve_64_json.h"
#include "pictures/external.h"
#include "pictures/flight_figure.h"
#include "pictures/gain_figure.h"

namespace nuno {
namespace {

namespace fs = std::filesystem;
using namespace figures;

SceneFile own_scene(std::string_view json, const std::string& name) {
  return make_scene_file(name, parse_scene(std::string(json), name));
}

Rollout flown(const SceneFile& file, const Backend& backend, double gain) {
  Rollout flight = rollout(backend, gain, {.frames_per_second = file.scene.frames_per_second});
  if (diverged(flight)) report_divergence(file.path, backend, flight);
  return flight;
}

/// The gains that figure 5 shows: from where control does nothing to what engines resolve.
GlobalSearchOptions fine_scan(Index scan) {
  GlobalSearchOptions options;
  options.smallest_gain = 0.3;
  options.scan = scan;
  return options;
}

GainCurve gain_curve(const SceneFile& file, const Backend& backend, Index scan) {
  const Objective errors = with_progress(
      objective(backend), fmt::format("figure 5: {} on {}", file.scene.name, backend.name()));
  GainCurve curve{.backend = std::string(backend.name()),
                  .launch_only_error = errors.errors(std::vector<double>{0})[0]};
  const OptimizeSummary best = global_search(errors, fine_scan(scan));
  for (const Evaluation& point : best.history) {
    // The refinement's points crowd at the minima; the curve is the scan's.
    const bool crowded = !curve.curve.empty() && point.gain < curve.curve.back().gain * 1.002;
    if (point.gain > 0 && !crowded) curve.curve.push_back(point);
  }
  curve.descent = steepest_descent(errors).history;
  curve.best = {best.gain, best.error};
  clear_progress();
  return curve;
}

struct Figure {
  std::string name;
  std::string svg;
};

Figure figure_5(const SceneFile& file) {
  std::vector<GainCurve> curves;
  for (const std::string_view name : chain_engines) {
    const auto backend = make_backend(name, file);
    curves.push_back(gain_curve(file, *backend, name == "native" ? 1000 : 200));
  }
  const Drawing drawing = draw_gain_curves(
      curves, file.problem.cloth().size,
      {.title = "Error at arrival against the gain of the shape control",
       .subtitle = fmt::format("{}, {} particles, t₀ = {} s, both engines", file.scene.name,
                               file.problem.cloth().particles(), file.scene.arrival_time)});
  return {"figure-5", drawing.svg()};
}

Figure flight_figure(const std::string& name, const std::string& title, const SceneFile& file,
                     const Backend& backend, double gain, const std::string& how) {
  const Rollout flight = flown(file, backend, gain);
  const double percent = 100 / file.problem.cloth().size;
  const FlightFigure options{
      .title = title,
      .subtitle = fmt::format("{} particles, α = {} N/m{}: mean error {:.2f} % of the cloth’s "
                              "length, worst particle {:.1f} %",
                              file.problem.cloth().particles(), shown(gain), how,
                              percent * flight.error.mean, percent * flight.error.max)};
  return {name, draw_flights({make_flight(file.scene.name, backend, flight)}, options).svg()};
}

/// The gain that the paper's optimiser finds.
double descended(const SceneFile& file, const Backend& backend) {
  const double gain =
      steepest_descent(with_progress(objective(backend), file.scene.name + ": steepest descent"))
          .gain;
  clear_progress();
  return gain;
}

}  // namespace

ExitStatus make_figures(const FiguresOptions& options) {
  create_folder(options.out);
  const auto path = [&](const std::string& name) {
    return (fs::path(options.out) / name).string();
  };
  require_writable(path("figure-5.svg"));

  const SceneFile file_32 = own_scene(embedded::s_curve_32_json, "s-curve-32");
  const SceneFile file_64 = own_scene(embedded::s_curve_64_json, "s-curve-64");
  const auto native_32 = make_backend("native", file_32);
  const auto native_64 = make_backend("native", file_64);
  const std::string how = " by steepest descent";
  const std::vector<Figure> all = {
      figure_5(file_32),
      flight_figure("figure-6", "Launch only: the place is right, both ends are wrong", file_32,
                    *native_32, 0, ""),
      flight_figure("figure-7", "With shape control at the descent’s gain", file_32, *native_32,
                    descended(file_32, *native_32), how),
      flight_figure("figure-8", "The same with twice the particles", file_64, *native_64,
                    descended(file_64, *native_64), how),
  };
  for (const Figure& figure : all) {
    write_output(path(figure.name + ".svg"), [&](std::FILE* file) {
      std::fwrite(figure.svg.data(), 1, figure.svg.size(), file);
    });
    fmt::print("{}\n", path(figure.name + ".svg"));
  }
  std::fflush(stdout);
  require_png();
  for (const Figure& figure : all) {
    write_output(path(figure.name + ".png"), [&](std::FILE* file) { write_png(figure.svg, file); });
    fmt::print("{}\n", path(figure.name + ".png"));
  }
  return ExitStatus::done;
}

}  // namespace nuno
