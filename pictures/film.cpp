#include "pictures/film.h"

#include <fmt/format.h>

#include <nuno/scene.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>

#include <nuno/output.h>
#include "pictures/external.h"

namespace nuno {
namespace {

constexpr double most_frames = 20'000;  // five minutes at 60 per second

std::string extension_of(const std::string& name) {
  return std::filesystem::path(name).extension().string();
}

}  // namespace

void require_film_maker(const std::string& name) {
  require_program("ffmpeg", "ffmpeg", fmt::format("a film ({})", extension_of(name).substr(1)));
}

void write_film(const std::vector<figures::Flight>& flights, const figures::FlightFigure& figure,
                const FilmOptions& options, std::FILE* out) {
  const std::string extension = extension_of(options.name);
  // A GIF's frames last whole hundredths of a second.
  const double frames_per_second = extension == ".gif" ? 25 : 60;
  const double shown_for = last_arrival(flights) / options.speed + figures::rest_at_arrival;
  if (!(shown_for * frames_per_second <= most_frames)) {
    throw InputError(fmt::format("--speed: {} makes a film of {:.3g} s, which is not <= {:.3g} s",
                                 options.speed, shown_for, most_frames / frames_per_second));
  }
  const int count = std::max(2, static_cast<int>(std::lround(shown_for * frames_per_second)));

  const int arrived = std::min(
      count - 1, static_cast<int>(
                     std::ceil(last_arrival(flights) / options.speed * frames_per_second - 1e-9)));
  double share = 0;  // that is made
  const auto proceed = [&] {
    if (options.progress) options.progress(share);
    stop_where_ended();
  };
  const auto moment = [&](int i) {
    return draw_moment(flights, i / frames_per_second * options.speed, figure);
  };
  // ffmpeg itself makes pictures of SVG, in half the time that they take through PNG. It finds each
  // in a pipe if all are as long as the longest; blanks at the end of a file do no harm.
  std::size_t length = 0;
  for (int i = 0; i <= arrived; ++i) {
    length = std::max(length, moment(i).svg().size());
    proceed();
  }
  const double width = moment(0).size().x * (extension == ".gif" ? 1 : png_scale);
  // At rest the last picture stays.
  const std::string rest = fmt::format("tpad=stop_mode=clone:stop={}", count - 1 - arrived);

  std::vector<std::string> arguments = {"ffmpeg", "-y"};
  const auto add = [&](std::initializer_list<std::string> more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  add({"-loglevel", "error", "-xerror"});  // or it passes over a full disk
  add({"-f", "image2pipe", "-frame_size", fmt::format("{}", length)});
  add({"-framerate", fmt::format("{}", frames_per_second)});
  add({"-width", fmt::format("{}", width), "-c:v", "librsvg", "-i", "pipe:0"});
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
  // Opened anew by its name, see film.h.
  add({"/dev/stdout"});

  run_program(
      arguments,
      [&](const Feed& feed) {
        for (int i = 0; i <= arrived; ++i) {
          std::string svg = moment(i).svg();
          svg.resize(length, ' ');
          feed(svg);
          show_progress(fmt::format("{}: frame {} of {}", options.name, i + 1, arrived + 1));
          share = static_cast<double>(i + 1) / (arrived + 1);
          proceed();
        }
      },
      out, proceed);
  clear_progress();
}

}  // namespace nuno
