#include "studio/api.h"

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <set>
#include <string_view>
#include <utility>

#include <nuno/output.h>
#include "studio/downloads.h"

namespace nuno::studio {
namespace {

struct Route {
  std::string_view method, path;
  std::set<std::string_view> options;  ///< that it takes
  Answer (*answer)(const Request&);
};

const std::array<Route, 12> routes = {{
    {"GET", "/api/about", {}, about_answer},
    {"GET", "/api/progress", {"page"}, progress_answer},
    {"POST", "/api/scene", {}, scene_answer},
    {"POST", "/api/meshes", {}, meshes_answer},
    {"POST", "/api/drawings", {}, drawings_answer},
    {"POST",
     "/api/optimize",
     {"page", "backend", "optimizer", "warm_start", "refine", "frames", "after", "judge"},
     optimize_answer},
    {"POST",
     "/api/simulate",
     {"page", "backend", "alpha", "frames", "after", "judge"},
     simulate_answer},
    {"POST", "/api/pareto_front", {"page", "backend"}, pareto_front_answer},
    {"POST", "/api/result", {"page", "backend", "optimizer", "alpha", "refine"}, result_answer},
    {"POST",
     "/api/animation",
     {"page", "backend", "optimizer", "alpha", "refine", "format"},
     animation_answer},
    {"POST", "/api/film", {"page", "backend", "optimizer", "alpha", "refine"}, film_answer},
    {"POST", "/api/report", {"page"}, report_answer},
}};

const Route* find_route(const std::string& path) {
  const auto route = std::ranges::find(routes, path, &Route::path);
  return route == routes.end() ? nullptr : &*route;
}

/// What `make` answers, or the refusal for what it throws.
template <typename Make>
Answer answer_or_refusal(const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    return refusal(400, error.what());
  } catch (const OutputError& error) {
    return refusal(503, error.what());
  } catch (const Stopped&) {
    return refusal(409, "a newer request of this page took its place");
  } catch (const std::bad_alloc&) {
    return refusal(413, "the scene needs more memory than there is");
  }
}

/// A request that works, and the end of its turn, and of the line that told its progress, however
/// the work ends.
struct AtWork {
  Turns& turns;
  Request request;

  ~AtWork() {
    turns.forget(request.options.page, request.turn);
    clear_progress();
  }
};

}  // namespace

Answer Api::get(const std::string& path, const Parameters& parameters) {
  const Route* const route = find_route(path);
  if (!route) return refusal(404, "there is no such page");
  if (route->method != "GET") {
    Answer answer = refusal(405, path + ": takes POST with a scene");
    answer.allow = "POST";
    return answer;
  }
  return answer_or_refusal([&] {
    const Options options = read_options(parameters, route->options);
    return route->answer({{}, options, turns_.running(options.page)});
  });
}

std::variant<Answer, Work> Api::post(const std::string& path, const Parameters& parameters,
                                     std::string body) {
  const Route* const route = find_route(path);
  if (!route) return refusal(404, "there is no such page");
  if (route->method != "POST") {
    Answer answer = refusal(405, path + ": takes GET");
    answer.allow = "GET, HEAD";
    return answer;
  }
  std::shared_ptr<AtWork> work;
  const Answer refused = answer_or_refusal([&]() -> Answer {
    const Options options = read_options(parameters, route->options);
    Request request{std::move(body), options, turns_.begin(options.page)};
    work.reset(new AtWork{turns_, std::move(request)});
    return {};
  });
  if (!work) return refused;
  return Work{[route, work] {
                return answer_or_refusal([&] {
                  work->request.turn.check();
                  return route->answer(work->request);
                });
              },
              work->request.turn};
}

}  // namespace nuno::studio
