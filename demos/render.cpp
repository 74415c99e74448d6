// nuno render: results as a still, a moving SVG or a film.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include <nuno/conditioning.h>
#include <nuno/engines.h>
#include <nuno/input.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include "commands.h"
#include "pictures/drawn_result.h"
#include "pictures/external.h"
#include "pictures/film.h"
#include "pictures/flight_figure.h"

namespace nuno {
namespace {

using namespace figures;

/// What a scene comes to: native at the best gain.
std::optional<Flight> thrown(const std::string& text, const std::string& path) {
  const SceneFile file = make_scene_file(name_of_input(path), parse_any_scene(text, path));
  require_few_frames(file);
  const auto backend = make_backend("native", file);
  const double gain =
      run_optimizer("global", with_progress(objective(*backend), file.scene.name)).gain;
  clear_progress();
  const Rollout flight =
      rollout(*backend, gain, {.frames_per_second = file.scene.frames_per_second});
  if (diverged(flight)) {
    report_divergence(file.path, *backend, flight);
    return std::nullopt;
  }
  return make_flight(file.scene.name, *backend, flight);
}

}  // namespace

ExitStatus render(const RenderOptions& options) {
  const std::string extension = std::filesystem::path(options.out).extension().string();
  if (std::ranges::find(render_extensions, extension) == render_extensions.end()) {
    throw InputError(fmt::format("--out: \"{}\" does not end in {}", options.out,
                                 fmt::join(render_extensions, ", ")));
  }
  const bool is_svg = extension == ".svg", is_png = extension == ".png";
  std::vector<Flight> flights;
  for (const std::string& path : options.results) {
    const std::string text = read_input(path);  // once: it may be a pipe
    const std::string name = name_of_input(path);
    std::optional<Flight> flight =
        is_scene(text, name) ? thrown(text, path) : parse_result(text, name);
    if (!flight) return ExitStatus::diverged;
    flights.push_back(std::move(*flight));
  }
  if (is_png) require_png();
  if (!is_svg && !is_png) require_film_maker(options.out);
  require_writable(options.out);

  const FlightFigure figure = captioned(flights, options.plain);
  write_output(options.out, [&](std::FILE* file) {
    if (is_svg) {
      const std::string svg = (options.still ? draw_flights(flights, figure)
                                             : draw_motion(flights, options.speed, figure))
                                  .svg();
      std::fwrite(svg.data(), 1, svg.size(), file);
    } else if (is_png) {
      write_png(draw_flights(flights, figure).svg(), file);
    } else {
      write_film(flights, figure, {.name = options.out, .speed = options.speed}, file);
    }
  });
  return ExitStatus::done;
}

}  // namespace nuno
