#include "studio/page_files.h"

#include <array>

#include "embedded/chart_js.h"
#include "embedded/charts_js.h"
#include "embedded/client_js.h"
#include "embedded/demo_scenes.h"
#include "embedded/editor_js.h"
#include "embedded/fields_js.h"
#include "embedded/files_js.h"
#include "embedded/gallery_js.h"
#include "embedded/geometry_js.h"
#include "embedded/hint_js.h"
#include "embedded/index_html.h"
#include "embedded/keyboard_js.h"
#include "embedded/latency_js.h"
#include "embedded/numbers_js.h"
#include "embedded/orbitcontrols_js.h"
#include "embedded/player_js.h"
#include "embedded/preview_js.h"
#include "embedded/scene_js.h"
#include "embedded/scores_js.h"
#include "embedded/shadow_js.h"
#include "embedded/sheet_js.h"
#include "embedded/space_js.h"
#include "embedded/space_stage_js.h"
#include "embedded/stage_js.h"
#include "embedded/state_js.h"
#include "embedded/studio_css.h"
#include "embedded/studio_js.h"
#include "embedded/three_module_js.h"
#include "embedded/throws_js.h"
#include "embedded/transformcontrols_js.h"
#include "embedded/view_js.h"

namespace nuno::studio {
namespace {

// A function: constants of other source files are made before main, in an unknown order.
std::array<PageFile, 30> page_files() {
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
           {"/gallery.js", js, gallery_js},
           {"/geometry.js", js, geometry_js},
           {"/hint.js", js, hint_js},
           {"/keyboard.js", js, keyboard_js},
           {"/latency.js", js, latency_js},
           {"/numbers.js", js, numbers_js},
           {"/player.js", js, player_js},
           {"/preview.js", js, preview_js},
           {"/scene.js", js, scene_js},
           {"/scores.js", js, scores_js},
           {"/shadow.js", js, shadow_js},
           {"/sheet.js", js, sheet_js},
           {"/space.js", js, space_js},
           {"/space_stage.js", js, space_stage_js},
           {"/stage.js", js, stage_js},
           {"/state.js", js, state_js},
           {"/studio.js", js, studio_js},
           {"/throws.js", js, throws_js},
           {"/view.js", js, view_js},
           // At the places where they look for one another.
           {"/build/three.module.js", js, three_module_js},
           {"/examples/jsm/controls/OrbitControls.js", js, orbitcontrols_js},
           {"/examples/jsm/controls/TransformControls.js", js, transformcontrols_js}}};
}

}  // namespace

std::optional<PageFile> page_file(std::string_view path) {
  for (const PageFile& file : page_files()) {
    if (file.path == path) return file;
  }
  constexpr std::string_view folder = "/scenes/";
  if (!path.starts_with(folder)) return std::nullopt;
  for (const auto& [name, text] : embedded::demo_scenes()) {
    if (name != path.substr(folder.size())) continue;
    const bool is_json = name.ends_with(".json");
    return PageFile{path, is_json ? "application/json" : "text/plain; charset=utf-8", text};
  }
  return std::nullopt;
}

std::vector<std::string> demo_names() {
  std::vector<std::string> names;
  for (const auto& [name, text] : embedded::demo_scenes()) {
    if (name.ends_with(".json")) names.emplace_back(name);
  }
  return names;
}

}  // namespace nuno::studio
