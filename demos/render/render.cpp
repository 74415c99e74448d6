// nuno render: results as a still, a moving SVG or a film.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "../commands.h"
#include "../engines.h"
#include "../figures/external.h"
#include "../figures/flight_figure.h"
#include "../output.h"
#include "../rollouts.h"
#include "result_file.h"

namespace nuno {
namespace {

using namespace figures;

constexpr double most_frames = 20'000;  // five minutes at 60 per second

/// What a scene comes to: native at the best gain.
std::optional<Flight> thrown(const std::string& path) {
  const SceneFile file = read_scene_file(path);
  require_few_frames(file);
  const auto backend = make_backend("native", file);
  const double gain =
      run_optimizer("global", with_progress(objective(*backend), file.scene.name)).gain;
  clear_progress();
  const Rollout flight =
      rollout(*backend, gain, {.frames_per_second = file.scene.frames_per_second});
  if (diverged(flight)) {
    report_divergence(path, *backend, flight);
    return std::nullopt;
  }
  return make_flight(file.scene.name, *backend, flight);
}

FlightFigure figure_of(const std::vector<Flight>& flights, bool plain) {
  FlightFigure figure;
  figure.plain = plain;
  if (plain) figure.ghosts = 3;
  const Flight& first = flights.front();
  if (flights.size() == 1) {
    figure.title = first.scene;
    figure.subtitle =
        fmt::format("{}, {} particles, α = {} N/m: mean error {:.3g} % of the cloth’s length",
                    engine_name(first.backend), first.target.cols(), shown(first.gain),
                    100 * first.error / first.cloth_length);
  } else {
    const bool one_scene = std::ranges::all_of(
        flights, [&](const Flight& flight) { return flight.scene == first.scene; });
    figure.title = one_scene ? first.scene : fmt::format("{} throws", flights.size());
    figure.subtitle = "target: the broad line; errors in % of the cloth’s length";
  }
  return figure;
}

void write_film(const std::vector<Flight>& flights, const FlightFigure& figure,
                const RenderOptions& options, const std::string& extension, std::FILE* out) {
  // A GIF's frames last whole hundredths of a second.
  const double frames_per_second = extension == ".gif" ? 25 : options.frames_per_second;
  const double shown_for = last_arrival(flights) / options.speed + rest_at_arrival;
  if (!(shown_for * frames_per_second <= most_frames)) {
    throw InputError(fmt::format("--speed: {} makes a film of {:.3g} s, which is not <= {:.3g} s",
                                 options.speed, shown_for, most_frames / frames_per_second));
  }
  const int count = std::max(2, static_cast<int>(std::lround(shown_for * frames_per_second)));

  const int arrived = std::min(
      count - 1, static_cast<int>(
                     std::ceil(last_arrival(flights) / options.speed * frames_per_second - 1e-9)));
  const auto moment = [&](int i) {
    return draw_moment(flights, i / frames_per_second * options.speed, figure);
  };
  // ffmpeg itself makes pictures of SVG, in half the time that they take through PNG. It finds each
  // in a pipe if all are as long as the longest; blanks at the end of a file do no harm.
  std::size_t length = 0;
  for (int i = 0; i <= arrived; ++i) length = std::max(length, moment(i).svg().size());
  const double width = moment(0).size().x * (extension == ".gif" ? 1 : png_scale);
  // At rest the last picture stays.
  const std::string rest = fmt::format("tpad=stop_mode=clone:stop={}", count - 1 - arrived);

  std::vector<std::string> arguments = {"ffmpeg",      "-y",
                                        "-loglevel",   "error",
                                        "-f",          "image2pipe",
                                        "-frame_size", fmt::format("{}", length),
                                        "-framerate",  fmt::format("{}", frames_per_second),
                                        "-width",      fmt::format("{}", width),
                                        "-c:v",        "librsvg",
                                        "-i",          "pipe:0"};
  const auto add = [&](std::initializer_list<std::string> more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  if (extension == ".gif") {
    add({"-vf", rest + ",split[a][b];[a]palettegen=max_colors=64[p];[b][p]paletteuse=dither=none",
         "-loop", "0", "-f", "gif"});
  } else if (extension == ".mp4") {
    add({"-vf", rest, "-c:v", "libx264", "-preset", "medium", "-crf", "20", "-pix_fmt", "yuv420p",
         "-movflags", "+faststart", "-f", "mp4"});
  } else {
    add({"-vf", rest, "-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-deadline", "realtime",
         "-cpu-used", "6", "-row-mt", "1", "-pix_fmt", "yuv420p", "-f", "webm"});
  }
  // By its name and not as a pipe: a film is finished at its beginning.
  add({"/dev/stdout"});

  run_program(
      arguments,
      [&](std::FILE* ffmpeg) {
        for (int i = 0; i <= arrived; ++i) {
          std::string svg = moment(i).svg();
          svg.resize(length, ' ');
          std::fwrite(svg.data(), 1, length, ffmpeg);
          show_progress(fmt::format("{}: frame {} of {}", options.out, i + 1, arrived + 1));
          if (options.progress) options.progress(static_cast<double>(i + 1) / (arrived + 1));
        }
      },
      out);
  clear_progress();
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
    std::optional<Flight> flight = is_scene_file(path) ? thrown(path) : read_result(path);
    if (!flight) return ExitStatus::diverged;
    flights.push_back(std::move(*flight));
  }
  if (is_png) require_png();
  if (!is_svg && !is_png) {
    require_program("ffmpeg", "ffmpeg", "a film (" + extension.substr(1) + ")");
  }
  require_writable(options.out);

  const FlightFigure figure = figure_of(flights, options.plain);
  write_output(options.out, [&](std::FILE* file) {
    if (is_svg) {
      const std::string svg = (options.still ? draw_flights(flights, figure)
                                             : draw_motion(flights, options.speed, figure))
                                  .svg();
      std::fwrite(svg.data(), 1, svg.size(), file);
    } else if (is_png) {
      write_png(draw_flights(flights, figure).svg(), file);
    } else {
      write_film(flights, figure, options, extension, file);
    }
  });
  return ExitStatus::done;
}

}  // namespace nuno
