#include "api.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <nuno/rollout.h>
#include <nuno/trade_off.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "../comparison.h"
#include "../engines.h"
#include "../json_files.h"
#include "../output.h"
#include "../render/film.h"
#include "../report/report.h"
#include "../rollouts.h"
#include "flight.h"

namespace nuno::studio {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

// What messages call the body of a request: the page saves it under a name like this.
constexpr const char* scene_name = "scene.json";

// A page waits for its answer: more than this for one rollout belongs on the command line.
constexpr double most_particle_steps_native = 5e7;
constexpr double most_particle_steps_box2d = 2e7;
constexpr double most_work_of_a_trade_off_native = 1e9;
constexpr double most_work_of_a_trade_off_box2d = 5e7;
constexpr Index most_frames = 2000;
constexpr double most_points_in_frames = 2e6;
constexpr double most_flights_after = 10;  // seconds after arrival, in arrival times
constexpr double longest_film = 10;        // seconds
constexpr std::size_t longest_page = 64;

// A search for an eye that watches the shape change: a thousandth of the error more or less is
// below what it sees.
constexpr GlobalSearchOptions while_changing = {
    .rounds = 3, .gain_tolerance = 1e-3, .error_tolerance = 1e-3};

std::string dump(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Calls `write` with a FILE that ends up in a string.
template <typename Write>
std::string printed(const Write& write) {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* const file = open_memstream(&text, &size);
  if (!file) throw std::bad_alloc();
  try {
    write(file);
  } catch (...) {
    std::fclose(file);
    std::free(text);
    throw;
  }
  std::fclose(file);
  std::string result(text, size);
  std::free(text);
  return result;
}

std::string contents(std::FILE* file) {
  std::rewind(file);
  std::string text;
  std::array<char, 65536> part;
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), file)) {
    text.append(part.data(), size);
  }
  return text;
}

/// The options of a request, named as the command line's are.
struct Options {
  std::string page;
  std::string backend{backend_names.front()};
  std::string optimizer{optimizer_names.front()};
  double alpha = 0;
  bool has_alpha = false;
  std::optional<double> warm_start;
  bool refine = false;
  Index frames = 0;
  double after = 0;
};

double number(const std::string& name, const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) {
    throw InputError(fmt::format("{}: {} is not a finite number", name, dump(text)));
  }
  if (!(value >= 0)) throw InputError(fmt::format("{}: {} is not >= 0", name, text));
  return value;
}

template <typename Words>
std::string word(const std::string& name, const std::string& text, const Words& words) {
  if (std::ranges::find(words, text) == std::end(words)) {
    throw InputError(
        fmt::format("{}: {} is not one of {}", name, dump(text), fmt::join(words, ", ")));
  }
  return text;
}

/// Throws InputError for a parameter that is not among `known`, stands twice or has a bad value.
Options read_options(const Parameters& parameters, const std::set<std::string_view>& known) {
  Options options;
  std::set<std::string_view> seen;
  for (const auto& [name, text] : parameters) {
    const std::string shown = dump(name.substr(0, longest_page));
    if (known.empty()) throw InputError(shown + ": this request takes no options");
    if (!known.contains(name)) {
      throw InputError(fmt::format("{}: is not one of {}", shown, fmt::join(known, ", ")));
    }
    if (!seen.insert(name).second) throw InputError(fmt::format("{}: stands twice", name));
    if (text.size() > longest_page) {
      throw InputError(fmt::format("{}: is longer than {} characters", name, longest_page));
    }
    if (name == "page") {
      options.page = text;
    } else if (name == "backend") {
      options.backend = word(name, text, backend_names);
    } else if (name == "optimizer") {
      options.optimizer = word(name, text, optimizer_names);
    } else if (name == "alpha") {
      options.alpha = number(name, text);
      options.has_alpha = true;
    } else if (name == "warm_start") {
      options.warm_start = number(name, text);
    } else if (name == "refine") {
      options.refine = word(name, text, std::array{"0", "1"}) == "1";
    } else if (name == "frames") {
      const double frames = number(name, text);
      if (frames != std::floor(frames) || frames > static_cast<double>(most_frames)) {
        throw InputError(
            fmt::format("{}: {} is not a whole number within 0 … {}", name, text, most_frames));
      }
      options.frames = static_cast<Index>(frames);
    } else {
      options.after = number(name, text);
    }
  }
  if (options.warm_start && options.optimizer != optimizer_names.front()) {
    throw InputError(fmt::format("warm_start: is not for the optimizer {}", options.optimizer));
  }
  if (options.refine && options.has_alpha) {
    throw InputError("refine: does not go with alpha, it has a gain of its own");
  }
  return options;
}

/// What one rollout takes, in particle-steps.
double work_of(const Backend& backend) {
  return static_cast<double>(backend.steps()) *
         static_cast<double>(backend.problem().chain.particles());
}

/// Throws InputError for a scene that would keep the page waiting for minutes.
void require_quick(const SceneFile& file, const Backend& backend, const Options& options) {
  const double particles = static_cast<double>(file.scene.particles);
  const double most =
      backend.name() == "native" ? most_particle_steps_native : most_particle_steps_box2d;
  if (work_of(backend) > most) {
    throw InputError(
        fmt::format("{}: /particles: {} is not few enough for the studio: with {} steps on {}, "
                    "this is for nuno optimize",
                    file.path, file.scene.particles, backend.steps(), backend.name()));
  }
  if (options.refine) require_few_particles_to_aim(file);
  if (options.after > most_flights_after * file.scene.arrival_time) {
    throw InputError(fmt::format("after: {} is not <= {}, {} arrival times", options.after,
                                 most_flights_after * file.scene.arrival_time, most_flights_after));
  }
  const double flight = 1 + options.after / file.scene.arrival_time;
  if (static_cast<double>(options.frames) * flight * particles > most_points_in_frames) {
    throw InputError(fmt::format("frames: {} is not <= {}", options.frames,
                                 std::floor(most_points_in_frames / particles / flight)));
  }
}

/// Throws InputError for a file of more frames than an answer should hold.
void require_few_frames_in_file(const Scene& scene) {
  const double most =
      most_points_in_frames / static_cast<double>(scene.particles) / scene.arrival_time;
  if (scene.frames_per_second > most) {
    throw InputError(fmt::format(
        "{}: /frames_per_second: {} is not <= {:.4g}, the most that the studio makes a "
        "file of with {} particles over {} s",
        scene_name, scene.frames_per_second, most, scene.particles, scene.arrival_time));
  }
}

void append(std::string& text, const Points& points) {
  text += '[';
  for (Index i = 0; i < points.cols(); ++i) {
    fmt::format_to(std::back_inserter(text), "{}[{:.7g},{:.7g}]", i ? "," : "", points(0, i),
                   points(1, i));
  }
  text += ']';
}

void append(std::string& text, const std::vector<Points>& shapes) {
  text += '[';
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (i > 0) text += ',';
    append(text, shapes[i]);
  }
  text += ']';
}

Json to_json(const OptimizeSummary& summary, const std::string& optimizer) {
  Json history = Json::array();
  for (const Evaluation& evaluation : summary.history) {
    if (!std::isfinite(evaluation.error)) continue;
    history.push_back({{"alpha", evaluation.gain}, {"error", evaluation.error}});
  }
  return {{"optimizer", optimizer},
          {"status", summary.status == OptimizeStatus::converged ? "converged" : "budget"},
          {"alpha", summary.gain},
          {"evaluations", summary.evaluations},
          {"seconds", summary.seconds},
          {"reason", summary.reason},
          {"history", history}};
}

Json to_json(const RefineSummary& refinement) {
  Points at_arrival = Points::Zero(2, refinement.flight.final.cols());
  for (const Points& offset : refinement.aim_offset) at_arrival += offset;
  return {{"status", refinement.converged ? "converged" : "nearest"},
          {"error_before", refinement.error_before},
          {"largest_offset", at_arrival.colwise().norm().maxCoeff()},
          {"rollouts", refinement.rollouts},
          {"tangents", refinement.tangents},
          {"seconds", refinement.seconds},
          {"reason", refinement.reason}};
}

/// A finished throw: which engine, which gain, and how it was found.
struct Throw {
  SceneFile file;
  std::unique_ptr<Backend> backend;
  std::optional<OptimizeSummary> found;
  std::vector<Evaluation> between;  ///< more of E(α) where the search took long strides
  std::optional<RefineSummary> refined;
  Rollout flight;
};

/// The answer that the page draws: the numbers to their last bit, the frames to 7 digits.
std::string drawable(const Throw& done, const std::string& optimizer, const Flight& frames,
                     Clock::time_point start) {
  const Backend& backend = *done.backend;
  const Rollout& flight = done.flight;
  const Problem& problem = backend.problem();
  Json head = {{"scene", done.file.scene.name},
               {"backend", backend.name()},
               {"status", "ok"},
               {"alpha", flight.gain},
               {"time_step", backend.time_step()},
               {"steps", backend.steps()},
               {"cloth_length", problem.chain.length},
               {"target_scale", problem.target_scale},
               {"error",
                {{"mean", flight.error.mean},
                 {"max", flight.error.max},
                 {"centroid", flight.error.centroid},
                 {"relative", flight.error.mean / problem.chain.length}}},
               {"control_effort", flight.control_effort},
               {"effort_unit", effort_unit(problem)},
               {"max_strain", flight.max_strain}};
  if (done.found) {
    OptimizeSummary shown = *done.found;
    shown.history.insert(shown.history.end(), done.between.begin(), done.between.end());
    std::ranges::sort(shown.history, {}, &Evaluation::gain);
    head["optimization"] = to_json(shown, optimizer);
  }
  if (done.refined) head["refinement"] = to_json(*done.refined);
  std::string text = dump(head);
  text.pop_back();  // the brace: the shapes follow
  text += ",\"initial\":";
  append(text, problem.chain.initial);
  text += ",\"target\":";
  append(text, problem.target);
  text += ",\"final\":";
  append(text, flight.final);
  text += ",\"frames\":{\"times\":" + dump(frames.times) + ",\"positions\":";
  append(text, frames.positions);
  text += ",\"forces\":";
  append(text, frames.forces);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  fmt::format_to(std::back_inserter(text), "}},\"seconds\":{:.6g}}}", seconds);
  return text;
}

Answer diverged_answer(const SceneFile& file, const Backend& backend, const Rollout& flight) {
  return refusal(422, divergence_message(file.path, backend, flight));
}

OptimizeSummary search(const Options& options, const Objective& objective) {
  if (!options.warm_start) return run_optimizer(options.optimizer, objective);
  GlobalSearchOptions quick = while_changing;
  quick.warm_start = options.warm_start;
  return global_search(objective, quick);
}

/// Two errors more in each wide gap of a search's, for the curve to be smooth to the eye.
std::vector<Evaluation> between(const std::vector<Evaluation>& searched,
                                const Objective& objective) {
  constexpr double wide = 1.1;
  std::vector<double> gains;
  for (std::size_t i = 1; i < searched.size(); ++i) {
    const double from = searched[i - 1].gain, to = searched[i].gain;
    if (!(from > 0 && to > wide * from)) continue;
    for (const double along : {1.0 / 3, 2.0 / 3}) {
      gains.push_back(from * std::pow(to / from, along));
    }
  }
  const std::vector<double> errors = objective.errors(gains);
  std::vector<Evaluation> result;
  for (std::size_t i = 0; i < gains.size(); ++i) result.push_back({gains[i], errors[i]});
  return result;
}

/// As `nuno optimize` and `nuno simulate` do it, with their functions and options.
Throw run(const std::string& body, const Options& options, bool optimizes, const Turn& turn,
          bool keeps_frames) {
  Throw result;
  result.file = parse_scene_file(body, scene_name);
  SceneFile& file = result.file;
  if (keeps_frames) require_few_frames_in_file(file.scene);
  const auto made_ready = [&] {
    return optimizes ? make_backend(options.backend, file)
                     : make_backend_for_gain(options.backend, file, options.alpha);
  };
  result.backend = made_ready();
  require_quick(file, *result.backend, options);
  double gain = options.alpha;
  if (optimizes) {
    const Objective errors = cancellable(*result.backend, turn);
    result.found = search(options, errors);
    gain = result.found->gain;
    // Where they are cheap.
    if (errors.samples && !options.warm_start) {
      result.between = between(result.found->history, errors);
    }
  }
  turn.check();
  if (options.refine) {
    result.refined = aim_off(options.backend, file, {}, [&] { turn.check(); });
    gain = result.refined->flight.gain;
    file.problem.aim_offset = result.refined->aim_offset;
    result.backend = made_ready();
  }
  result.flight = rollout(*result.backend, gain,
                          {.frames_per_second = keeps_frames ? file.scene.frames_per_second : 0});
  return result;
}

Answer throw_answer(const std::string& body, const Options& options, bool optimizes,
                    const Turn& turn) {
  const auto start = Clock::now();
  const Throw done = run(body, options, optimizes, turn, false);
  if (diverged(done.flight)) return diverged_answer(done.file, *done.backend, done.flight);
  Flight frames;
  if (options.frames > 0) {
    frames = fly(*done.backend, done.flight.gain, options.frames, options.after, turn);
  }
  return {.body = drawable(done, options.optimizer, frames, start)};
}

/// The file that the command line's --out writes: simulate's where a gain is given.
Answer result_answer(const std::string& body, const Options& options, const Turn& turn) {
  const Throw done = run(body, options, !options.has_alpha, turn, true);
  if (diverged(done.flight)) return diverged_answer(done.file, *done.backend, done.flight);
  std::optional<Optimization> optimization;
  if (done.found) optimization = Optimization{options.optimizer, *done.found};
  if (done.refined) optimization->refinement = done.refined;
  return {.body = printed([&](std::FILE* file) {
            write_result(file, done.file.scene.name, *done.backend, done.flight,
                         bounded_sensitivity(*done.backend, done.flight), optimization);
          }),
          .file_name = "result.json"};
}

/// Both engines on the scene, as the page that `nuno compare` writes.
Answer report_answer(const std::string& body, const Options& options, const Turn& turn) {
  const SceneFile file = parse_scene_file(body, scene_name);
  const auto native = make_backend("native", file);
  const auto box2d = make_backend("box2d", file);
  require_quick(file, *native, options);
  require_quick(file, *box2d, options);
  const Comparison comparison = compare_engines(
      file.scene.name, *native, *box2d,
      {.objective_of = [&](const Backend& backend) { return cancellable(backend, turn); },
       .before_rollout = [&] { turn.check(); }});
  clear_progress();
  if (comparison.divergence) {
    const auto& [backend, flight] = *comparison.divergence;
    return diverged_answer(file, backend == "native" ? *native : *box2d, flight);
  }
  return {.type = "text/html; charset=utf-8",
          .body = report_page({make_report_scene(comparison, *native, *box2d)}),
          .file_name = "report.html"};
}

/// What `nuno render` makes of the result.
Answer film_answer(const std::string& body, const Options& options, const Turn& turn) {
  if (const double time = parse_scene_file(body, scene_name).scene.arrival_time;
      time > longest_film) {
    throw InputError(
        fmt::format("{}: /arrival_time: {} is not <= {}, the longest film of the studio",
                    scene_name, time, longest_film));
  }
  const std::string name = "film.mp4";
  const Throw done = run(body, options, !options.has_alpha, turn, true);
  if (diverged(done.flight)) return diverged_answer(done.file, *done.backend, done.flight);
  require_film_maker(name);
  // A file without a name: nothing of it stays, however the program ends.
  const File film(std::tmpfile());
  if (!film) throw OutputError(name + ": cannot be written: " + std::strerror(errno));
  turn.check();
  const std::vector flights = {
      figures::make_flight(done.file.scene.name, *done.backend, done.flight)};
  write_film(flights, figures::captioned(flights, false),
             {.name = name,
              .progress =
                  [&](double share) {
                    turn.check();
                    turn.report(share);
                  }},
             film.get());
  return {.type = "video/mp4", .body = contents(film.get()), .file_name = name};
}

/// What error costs in effort. A scene whose rollouts take long gets fewer points.
Answer trade_off_answer(const std::string& body, const Options& options, const Turn& turn) {
  const SceneFile file = parse_scene_file(body, scene_name);
  const auto backend = make_backend(options.backend, file);
  require_quick(file, *backend, options);
  turn.check();
  const double most = backend->name() == "native" ? most_work_of_a_trade_off_native
                                                  : most_work_of_a_trade_off_box2d;
  const double count = std::clamp(most / work_of(*backend), 8.0, 64.0);
  Json points = Json::array();
  for (const TradeOffPoint& point :
       trade_off(*backend, static_cast<Index>(count), [&] { turn.check(); })) {
    points.push_back(
        {{"alpha", point.gain}, {"error", point.error}, {"control_effort", point.effort}});
  }
  return {.body = dump({{"scene", file.scene.name},
                        {"backend", backend->name()},
                        {"cloth_length", backend->problem().chain.length},
                        {"effort_unit", effort_unit(backend->problem())},
                        {"trade_off", points}})};
}

Answer scene_answer(const std::string& body) {
  return {.body = nuno::to_json(parse_scene_file(body, scene_name).scene)};
}

Json about() {
  // A scene of defaults; the required fields are left out of it.
  Json defaults = Json::parse(nuno::to_json(Scene{}));
  for (const char* required : {"name", "arrival_time", "initial", "target"}) {
    defaults.erase(required);
  }
  return {{"version", NUNO_VERSION},
          {"backends", backend_names},
          {"optimizers", optimizer_names},
          {"defaults", defaults}};
}

using Names = std::set<std::string_view>;

const Names of_optimize = {"page",   "backend", "optimizer", "warm_start",
                           "refine", "frames",  "after"};
const Names of_simulate = {"page", "backend", "alpha", "frames", "after"};
const Names of_result = {"page", "backend", "optimizer", "alpha", "refine"};
const Names of_trade_off = {"page", "backend"};
const Names of_report = {"page"};

constexpr std::array<std::string_view, 7> posts = {
    "/api/optimize", "/api/simulate",  "/api/result", "/api/scene",
    "/api/report",   "/api/trade_off", "/api/film"};

}  // namespace

Answer refusal(int status, const std::string& message) {
  return {.status = status, .body = dump({{"error", message}})};
}

Answer Api::get(const std::string& path, const Parameters& parameters) try {
  if (path == "/api/about") {
    read_options(parameters, {});
    return {.body = dump(about())};
  }
  if (path == "/api/progress") {
    const Options options = read_options(parameters, {"page"});
    return {.body = dump({{"progress", turns_.progress(options.page)}})};
  }
  if (std::ranges::find(posts, path) != posts.end()) {
    return refusal(405, path + ": takes POST with a scene");
  }
  return refusal(404, "there is no such page");
} catch (const InputError& error) {
  return refusal(400, error.what());
}

Answer Api::post(const std::string& path, const Parameters& parameters, const std::string& body) {
  Turn turn;
  Options options;
  Answer answer;
  const auto begin = [&](const Names& known) {
    options = read_options(parameters, known);
    turn = turns_.begin(options.page);
  };
  try {
    if (path == "/api/scene") {
      begin({});
      answer = scene_answer(body);
    } else if (path == "/api/optimize") {
      begin(of_optimize);
      answer = throw_answer(body, options, true, turn);
    } else if (path == "/api/simulate") {
      begin(of_simulate);
      answer = throw_answer(body, options, false, turn);
    } else if (path == "/api/trade_off") {
      begin(of_trade_off);
      answer = trade_off_answer(body, options, turn);
    } else if (path == "/api/result") {
      begin(of_result);
      answer = result_answer(body, options, turn);
    } else if (path == "/api/film") {
      begin(of_result);
      answer = film_answer(body, options, turn);
    } else if (path == "/api/report") {
      begin(of_report);
      answer = report_answer(body, options, turn);
    } else if (path == "/" || path == "/api/about" || path == "/api/progress") {
      answer = refusal(405, path + ": takes GET");
    } else {
      answer = refusal(404, "there is no such page");
    }
  } catch (const InputError& error) {
    answer = refusal(400, error.what());
  } catch (const OutputError& error) {
    answer = refusal(503, error.what());
  } catch (const Cancelled&) {
    answer = refusal(409, "a newer request of this page took its place");
  } catch (const std::bad_alloc&) {
    answer = refusal(413, "the scene needs more memory than there is");
  }
  turns_.end(options.page, turn);
  return answer;
}

}  // namespace nuno::studio
