#include "studio/downloads.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <vector>

#include <nuno/animation.h>
#include <nuno/comparison.h>
#include <nuno/conditioning.h>
#include <nuno/output.h>
#include <nuno/parallel.h>
#include <nuno/progress.h>
#include <nuno/result_file.h>
#include <nuno/scene_file.h>
#include "pictures/film.h"
#include "pictures/flight_figure.h"
#include "pictures/report.h"
#include "studio/throw.h"

namespace nuno::studio {
namespace {

constexpr double longest_film = 10;  // seconds of flight

std::string contents(std::FILE* file, const std::string& name) {
  std::rewind(file);
  std::string text;
  std::array<char, 65536> part;
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), file)) {
    text.append(part.data(), size);
  }
  if (std::ferror(file)) throw OutputError(name + ": cannot be read back");
  return text;
}

/// The same objective, which tells how many gains it flies: all of a batch where they fly side by
/// side, as with derivatives; else one after the other, each of which takes long.
Objective counted(Objective objective, const std::function<void(std::size_t)>& tell) {
  objective.errors = [tell, errors = objective.errors,
                      in_batches = static_cast<bool>(objective.samples)](auto gains) {
    if (in_batches) {
      tell(gains.size());
      return errors(gains);
    }
    std::vector<double> result(gains.size());
    parallel_for(static_cast<Index>(gains.size()), [&](Index i) {
      const auto at = static_cast<std::size_t>(i);
      result[at] = errors(gains.subspan(at, 1)).front();
      tell(1);
    });
    return result;
  };
  return objective;
}

/// A comparison that tells how much of the report it is for is done.
Comparison compare_for(const Request& request, const std::string& scene, const Backend& first,
                       const Backend& second) {
  constexpr double usual_rollouts = 330;  // two searches and three curves
  constexpr double most = 0.95;           // the flights to be looked at follow
  std::atomic<std::size_t> flown = 0;
  const auto tell = [&](std::size_t rollouts) {
    request.turn.check();
    request.turn.report(std::min(most, static_cast<double>(flown += rollouts) / usual_rollouts));
  };
  return compare_engines(
      scene, first, second,
      {.objective_of = [&](const Backend& backend) { return counted(objective(backend), tell); },
       .before_rollout = [&] { tell(1); }});
}

}  // namespace

Answer result_answer(const Request& request) {
  const Throw done = throw_cloth(request, request.options.alpha, KeptFrames::of_scene);
  if (diverged(done.flight)) return diverged_answer(done.file, *done.backend, done.flight);
  std::optional<Optimization> optimization;
  if (done.found) optimization = Optimization{request.options.optimizer, *done.found};
  if (done.refined) optimization->refinement = done.refined;
  return {.body = written_text([&](std::FILE* file) {
            write_result(file, done.file.input, *done.backend, done.flight,
                         done.sensitivity.value(), optimization);
          }),
          .file_name = "result.json"};
}

Answer animation_answer(const Request& request) {
  const Throw done = throw_cloth(request, request.options.alpha, KeptFrames::of_scene);
  if (diverged(done.flight)) return diverged_answer(done.file, *done.backend, done.flight);
  const std::string& format = request.options.format;
  const double frames_per_second = done.file.scene.frames_per_second;
  require_animation("flight" + format, done.file.scene.arrival_time, frames_per_second);
  const Cloth& cloth = done.backend->cloth();
  const double width = ribbon_width(cloth.size);
  Animation animation{
      .name = done.file.scene.name,
      .mesh = done.file.mesh() ? *done.file.mesh() : ribbon_mesh(cloth.initial, width),
      .frames_per_second = frames_per_second,
      .times = done.flight.frame_times,
      .positions = done.flight.frame_positions};
  if (!done.file.mesh()) {
    for (Points& shape : animation.positions) shape = ribbon(shape, width);
  }
  return {.type = format == ".glb" ? "model/gltf-binary" : "application/octet-stream",
          .body = written_text([&](std::FILE* file) { write_animation(file, format, animation); }),
          .file_name = "flight" + format};
}

Answer report_answer(const Request& request) {
  const SceneFile file = read_scene(request);
  const auto& [one, other] = engines_for(file.problem);
  const auto first = make_backend(one, file), second = make_backend(other, file);
  require_quick(file, *first, request.options);
  require_quick(file, *second, request.options);
  const Comparison comparison = compare_for(request, file.scene.name, *first, *second);
  if (comparison.divergence) {
    const auto& [backend, flight] = *comparison.divergence;
    return diverged_answer(file, backend == one ? *first : *second, flight);
  }
  return {.type = "text/html; charset=utf-8",
          .body = report_page({make_report_scene(comparison, *first, *second)}),
          .file_name = "report.html"};
}

Answer film_answer(const Request& request) {
  if (const SceneFile file = read_scene(request); file.scene.arrival_time > longest_film) {
    throw InputError(
        fmt::format("{}: /arrival_time: {} is not <= {}, the longest film of the studio", file.path,
                    file.scene.arrival_time, longest_film));
  }
  const std::string name = "film.mp4";
  require_film_maker(name);
  const Throw done = throw_cloth(request, request.options.alpha, KeptFrames::of_scene);
  if (diverged(done.flight)) return diverged_answer(done.file, *done.backend, done.flight);
  // A file without a name: nothing of it stays, however the program ends.
  const File film(std::tmpfile());
  if (!film) throw OutputError(name + ": cannot be written: " + std::strerror(errno));
  request.turn.check();
  const std::vector flights = {
      figures::make_flight(done.file.scene.name, *done.backend, done.flight)};
  write_film(flights, figures::captioned(flights, false),
             {.name = name,
              .progress =
                  [&](double share) {
                    request.turn.check();
                    request.turn.report(share);
                  }},
             film.get());
  return {.type = "video/mp4", .body = contents(film.get(), name), .file_name = name};
}

}  // namespace nuno::studio
