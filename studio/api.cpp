#include "studio/api.h"

#include <algorithm>
#include <array>
#include <new>
#include <optional>
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

const std::array<Route, 9> routes = {{
    {"GET", "/api/about", {}, about_answer},
    {"GET", "/api/progress", {"page"}, progress_answer},
    {"POST", "/api/scene", {}, scene_answer},
    {"POST",
     "/api/optimize",
     {"page", "backend", "optimizer", "warm_start", "refine", "frames", "after"},
     optimize_answer},
    {"POST", "/api/simulate", {"page", "backend", "alpha", "frames", "after"}, simulate_answer},
    {"POST", "/api/pareto_front", {"page", "backend"}, pareto_front_answer},
    {"POST", "/api/result", {"page", "backend", "optimizer", "alpha", "refine"}, result_answer},
    {"POST", "/api/film", {"page", "backend", "optimizer", "alpha", "refine"}, film_answer},
    {"POST", "/api/report", {"page"}, report_answer},
}};

/// Ends a request's turn, and the line that told its progress, however its work ends.
class AtWork {
 public:
  AtWork(Turns& turns, const Request& request) : turns_(turns), request_(request) {}
  ~AtWork() {
    turns_.end(request_.options.page, request_.turn);
    clear_progress();
  }
  AtWork(const AtWork&) = delete;
  AtWork& operator=(const AtWork&) = delete;

 private:
  Turns& turns_;
  const Request& request_;
};

}  // namespace

Answer Api::get(const std::string& path, const Parameters& parameters) {
  return answer("GET", path, parameters, "");
}

Answer Api::post(const std::string& path, const Parameters& parameters, std::string body) {
  return answer("POST", path, parameters, std::move(body));
}

Answer Api::answer(std::string_view method, const std::string& path, const Parameters& parameters,
                   std::string body) {
  const auto route = std::ranges::find(routes, path, &Route::path);
  if (route == routes.end()) return refusal(404, "there is no such page");
  const bool works = route->method == "POST";
  if (route->method != method) {
    return refusal(405, path + (works ? ": takes POST with a scene" : ": takes GET"));
  }
  Request request;
  request.body = std::move(body);
  std::optional<AtWork> at_work;
  if (works) at_work.emplace(turns_, request);
  try {
    request.options = read_options(parameters, route->options);
    const std::string& page = request.options.page;
    request.turn = works ? turns_.begin(page) : turns_.running(page);
    return route->answer(request);
  } catch (const InputError& error) {
    return refusal(400, error.what());
  } catch (const OutputError& error) {
    return refusal(503, error.what());
  } catch (const Cancelled&) {
    return refusal(409, "a newer request of this page took its place");
  } catch (const std::bad_alloc&) {
    return refusal(413, "the scene needs more memory than there is");
  }
}

}  // namespace nuno::studio
