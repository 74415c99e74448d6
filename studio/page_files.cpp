#include "studio/page_files.h"

#include <array>

#include "embedded/chart_js.h"
#include "embedded/charts_js.h"
#include "embedded/client_js.h"
#include "embedded/editor_js.h"
#include "embedded/fields_js.h"
#include "embedded/files_js.h"
#include "embedded/geometry_js.h"
#include "embedded/index_html.h"
#include "embedded/keyboard_js.h"
#include "embedded/latency_js.h"
#include "embedded/numbers_js.h"
#include "embedded/player_js.h"
#include "embedded/scene_js.h"
#include "embedded/scores_js.h"
#include "embedded/stage_js.h"
#include "embedded/state_js.h"
#include "embedded/studio_css.h"
#include "embedded/studio_js.h"
#include "embedded/throws_js.h"
#include "embedded/view_js.h"

namespace nuno::studio {
namespace {

// A function: constants of other source files are made before main, in an unknown order.
std::array<PageFile, 20> page_files() {
  using namespace embedded;
  constexpr std::string_view js = "text/javascript; charset=utf-8";
  return {{{"/", "text/html; charset=utf-8", index_html},
           {"/studio.css", "text/css; charset=utf-8", studio_css},
           {"/chart.js", js, chart_js},
           {"/charts.js", js, charts_js},
           {"/client.js", js, client_js},
           {"/editor.js", js, editor_js},
           {"/fields.js", js, fields_js},
           {"/files.js", js, files_js},
           {"/geometry.js", js, geometry_js},
           {"/keyboard.js", js, keyboard_js},
           {"/latency.js", js, latency_js},
           {"/numbers.js", js, numbers_js},
           {"/player.js", js, player_js},
           {"/scene.js", js, scene_js},
           {"/scores.js", js, scores_js},
           {"/stage.js", js, stage_js},
           {"/state.js", js, state_js},
           {"/studio.js", js, studio_js},
           {"/throws.js", js, throws_js},
           {"/view.js", js, view_js}}};
}

}  // namespace

std::optional<PageFile> page_file(std::string_view path) {
  for (const PageFile& file : page_files()) {
    if (file.path == path) return file;
  }
  return std::nullopt;
}

}  // namespace nuno::studio
