#include "studio/answers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <nuno/materials.h>
#include <nuno/pareto_front.h>
#include <nuno/scene_file.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <iterator>

#include <nuno/conditioning.h>
#include <nuno/feasibility.h>
#include <nuno/output.h>
#include <nuno/progress.h>
#include "formats/result_json.h"
#include "studio/page_files.h"
#include "studio/throw.h"
#include "studio/uploads.h"

namespace nuno::studio {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

std::string dump(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void append(std::string& text, const Points& points) {
  text += '[';
  for (Index i = 0; i < points.cols(); ++i) {
    const auto column = points.col(i);
    fmt::format_to(std::back_inserter(text), "{}[{:.7g}]", i ? "," : "", fmt::join(column, ","));
  }
  text += ']';
}

void append(std::string& text, const std::vector<Points>& shapes, const Turn& turn) {
  text += '[';
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    turn.check();
    if (i > 0) text += ',';
    append(text, shapes[i]);
  }
  text += ']';
}

Json to_json(const OptimizeSummary& summary, const std::string& optimizer) {
  Json result = search_head(optimizer, summary);
  result["alpha"] = summary.gain;
  result["history"] = history_of(summary);
  return result;
}

Json to_json(const RefineSummary& refinement) {
  Points at_arrival = Points::Zero(refinement.flight.final.rows(), refinement.flight.final.cols());
  for (const Points& offset : refinement.reference_correction) at_arrival += offset;
  Json result = refinement_head(refinement);
  result["largest_offset"] = at_arrival.colwise().norm().maxCoeff();
  if (std::isfinite(refinement.error_before)) result["error_before"] = refinement.error_before;
  return result;
}

Json points_json(const Points& points) {
  Json list = Json::array();
  for (Index i = 0; i < points.cols(); ++i) {
    list.push_back(std::vector<double>(points.col(i).begin(), points.col(i).end()));
  }
  return list;
}

/// What the page shows of a sheet alone.
void add_sheet(Json& head, const Problem& problem, const Rollout& flight) {
  head["kind"] = "sheet";
  head["faces"] = problem.sheet().faces;
  head["ground"] = ground_height(problem.cloth().initial, problem.target);
  std::vector<double> times = flight.frame_times;
  std::erase_if(times, [&](double time) {  // what comes after is nobody's wish
    return time > (1 + 1e-9) * problem.arrival_time;
  });
  const auto first = flight.frame_positions.begin();
  const std::vector<Points> positions(first, first + static_cast<std::ptrdiff_t>(times.size()));
  const FlightCrossings crossings = flight_crossings(problem, times, positions);
  head["crossings"] = crossings_head(crossings);
  head["crossings"]["faces"] = crossings.crossed_faces;
}

/// What stands in the way of a better throw, and whether this one can be trusted.
std::string remarks(const Throw& done) {
  std::string words = verdict(assess(*done.backend));
  if (!done.sensitivity) return words;
  std::string warning = caution(done.flight, *done.sensitivity, done.backend->time_step());
  if (warning.empty()) return words;
  warning[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(warning[0])));
  return words + (words.empty() ? "" : "\n") + warning + '.';
}

/// The answer that the page draws: the numbers to their last bit, the frames to 7 digits.
std::string drawable(const Throw& done, const Request& request, Clock::time_point start) {
  const Backend& backend = *done.backend;
  const Rollout& flight = done.flight;
  const Problem& problem = backend.problem();
  Json head = result_head(done.file.scene.name, backend, flight);
  if (done.sensitivity) head["sensitivity"] = *done.sensitivity;
  head["effort_unit"] = effort_unit(problem);
  if (done.found) {
    OptimizeSummary shown = *done.found;
    shown.history.insert(shown.history.end(), done.between.begin(), done.between.end());
    std::ranges::sort(shown.history, {}, &Evaluation::gain);
    head["optimization"] = to_json(shown, request.options.optimizer);
  }
  if (done.refined) head["refinement"] = to_json(*done.refined);
  if (problem.is_sheet()) add_sheet(head, problem, flight);
  head["remarks"] = remarks(done);
  std::string text = dump(head);
  text.pop_back();  // the brace: the shapes follow
  text += ",\"initial\":";
  append(text, problem.cloth().initial);
  text += ",\"target\":";
  append(text, problem.target);
  text += ",\"final\":";
  append(text, flight.final);
  text += ",\"frames\":{\"times\":" + dump(flight.frame_times) + ",\"positions\":";
  append(text, flight.frame_positions, request.turn);
  text += ",\"forces\":";
  append(text, flight.frame_forces, request.turn);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  fmt::format_to(std::back_inserter(text), "}},\"seconds\":{:.6g}}}", seconds);
  return text;
}

Answer throw_answer(const Request& request, std::optional<double> alpha) {
  const auto start = Clock::now();
  const Throw done = throw_cloth(request, alpha, KeptFrames::of_request);
  if (diverged(done.flight)) return diverged_answer(done.file, *done.backend, done.flight);
  return {.body = drawable(done, request, start)};
}

/// How many gains a pareto-front tries: fewer of a scene whose rollouts take long.
Index gains_of_pareto_front(const Backend& backend) {
  const double most_work = backend.name() == "native" ? 1e9 : 5e7;
  return static_cast<Index>(std::clamp(most_work / work_of(backend), 8.0, 64.0));
}

}  // namespace

Answer refusal(int status, const std::string& message) {
  return {.status = status, .body = dump({{"error", message_for_people(message)}})};
}

Answer diverged_answer(const SceneFile& file, const Backend& backend, const Rollout& flight) {
  return refusal(422, divergence_message(file.path, backend, flight));
}

Answer about_answer(const Request&) {
  // A scene of defaults; the required fields are left out of it.
  Json defaults = Json::parse(nuno::to_json(ChainScene{}));
  for (const char* required : {"name", "arrival_time", "initial", "target"}) {
    defaults.erase(required);
  }
  Json materials = Json::array();
  for (const NamedMaterial& material : named_materials()) materials.push_back(material.name);
  return {.body = dump({{"version", NUNO_VERSION},
                        {"backends", chain_engines},
                        {"sheet_backends", sheet_engines},
                        {"materials", materials},
                        {"demos", demo_names()},
                        {"optimizers", optimizer_names},
                        {"defaults", defaults}})};
}

Answer progress_answer(const Request& request) {
  return {.body = dump({{"progress", request.turn.progress()}})};
}

Answer scene_answer(const Request& request) {
  const AnyScene scene = parse_whole_scene(request.body, "scene.json");
  return {.body = std::visit([](const auto& any) { return nuno::to_json(any); }, scene)};
}

Answer meshes_answer(const Request& request) {
  const auto [start, end] = read_meshes(request.body);
  SheetScene scene;
  scene.arrival_time = 1;  // that of the throw is not known yet
  const SheetInput sheet =
      with_meshes(std::move(scene), start.path, start.mesh, end.path, end.mesh, "meshes");
  Json result = Json::parse(nuno::to_json(sheet));
  return {.body = dump({{"initial", result["initial"]},
                        {"target", result["target"]},
                        {"remarks", sheet.mesh.remarks}})};
}

Answer drawings_answer(const Request& request) {
  const Drawings drawn = read_drawings(request.body);
  Json result = {{"target", points_json(drawn.target)}};
  if (drawn.initial) result["initial"] = points_json(*drawn.initial);
  return {.body = dump(result)};
}

Answer optimize_answer(const Request& request) { return throw_answer(request, std::nullopt); }

Answer simulate_answer(const Request& request) {
  return throw_answer(request, request.options.alpha.value_or(0));
}

Answer pareto_front_answer(const Request& request) {
  const SceneFile file = read_scene(request);
  const auto backend = make_backend(request.options.backend, file);
  require_quick(file, *backend, request.options);
  Json points = Json::array();
  const Index count = gains_of_pareto_front(*backend);
  std::vector<Evaluation> tried;  // a search by values takes too long for a page
  if (backend->has_derivatives()) tried = global_search(objective(*backend)).history;
  for (const ParetoPoint& point : pareto_front(*backend, count, tried)) {
    points.push_back(
        {{"alpha", point.gain}, {"error", point.error}, {"control_effort", point.effort}});
  }
  return {.body = dump({{"scene", file.scene.name},
                        {"backend", backend->name()},
                        {"cloth_length", backend->problem().cloth().size},
                        {"effort_unit", effort_unit(backend->problem())},
                        {"pareto_front", points}})};
}

}  // namespace nuno::studio
