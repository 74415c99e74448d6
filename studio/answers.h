#pragma once

#include <nuno/backend.h>
#include <nuno/rollout.h>

#include <string>
#include <string_view>

#include <nuno/engines.h>
#include "studio/request.h"

namespace nuno::studio {

/// What a request gets.
struct Answer {
  int status = 200;  ///< of HTTP
  std::string type = "application/json";
  std::string body = {};
  std::string file_name = {};   ///< of a download; empty: none
  std::string_view allow = {};  ///< methods that are taken, with 405
};

/// {"error": message}
Answer refusal(int status, const std::string& message);

/// The refusal of a scene whose flight diverged.
Answer diverged_answer(const SceneFile& file, const Backend& backend, const Rollout& flight);

// What the page shows and draws, see API.md. They throw InputError and Stopped.
Answer about_answer(const Request& request);
Answer progress_answer(const Request& request);
Answer scene_answer(const Request& request);
Answer meshes_answer(const Request& request);
Answer drawings_answer(const Request& request);
Answer optimize_answer(const Request& request);
Answer simulate_answer(const Request& request);
Answer pareto_front_answer(const Request& request);

}  // namespace nuno::studio
