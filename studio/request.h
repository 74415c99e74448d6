#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include <nuno/engines.h>
#include <nuno/scene_file.h>
#include "studio/cancellation.h"

namespace nuno::studio {

/// The query of a request as it came.
using Parameters = std::multimap<std::string, std::string>;

/// The options of a request, named as the command line's are; API.md has their meaning.
struct Options {
  std::string page;
  std::string backend{chain_engines.front()};
  std::string optimizer{optimizer_names.front()};
  std::optional<double> alpha;
  std::optional<double> warm_start;
  bool refine = false;
  std::string format{".glb"};  ///< of an animation
  Index frames = 0;
  double after = 0;
  bool judge = false;
};

/// Throws InputError for a parameter that is not among `known`, stands twice or has a bad value.
Options read_options(const Parameters& parameters, const std::set<std::string_view>& known);

/// What an answer is made from.
struct Request {
  std::string body;  ///< a scene file
  Options options;
  Turn turn;  ///< of its own where there is work to do; else the one that its page has
};

/// The scene, whose work ends with the request's turn. Throws InputError for what is no scene.
SceneFile read_scene(const Request& request);

/// What one rollout takes, in particle-steps.
double work_of(const Backend& backend);

// A page waits for its answer: what takes longer than a few minutes, or more memory than a browser
// has, is for the command line.

/// Throws InputError for a scene that would keep the page waiting.
void require_quick(const SceneFile& file, const Backend& backend, const Options& options);

/// Throws InputError for a file of more frames than an answer should hold.
void require_few_frames_in_file(const SceneFile& file);

}  // namespace nuno::studio
