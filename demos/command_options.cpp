#include "command_options.h"

#include <nuno/animation.h>
#include <nuno/engines.h>
#include <nuno/materials.h>

#include <fmt/format.h>

#include <memory>

#include "arguments.h"
#include "studio/studio.h"

namespace nuno {
namespace {

constexpr const char* scene_file = "Scene file (JSON), or a result: the scene that it holds";

// Below the options of every command that throws scenes.
constexpr const char* which_reference = R"(What the control pulls towards is the scene's choice:
  "reference": "hold"    The target's shape from the first step on, as in the paper;
                         the default. To see the paper's method: it is near at few
                         gains only, and often fragile there.
  "reference": "morph"   A motion from the initial shape to the target. For all else:
                         nearer, calmer, at a fraction of the force.
  "damping_ratio": 0.7   With "morph": what swings about that motion dies away, and
                         more gain is less error. 0, the default, is the paper's:
                         E(α) swings, and compare ends at 100 m/t₀², where engines
                         still agree; optimize goes on from there.
  "arrival": "pass"      With "morph": in full swing, to fly on; the default.
  "arrival": "settle"    With "morph": the shape comes to rest, to be held or to be
                         looked at; takes a little more force.)";

/// --backend for a command that throws whatever the scene is.
void add_any_backend(CLI::App& command, std::string& backend) {
  add_backend(command, backend, backend_names,
              fmt::format("Engine: {} for chains, {} for sheets", fmt::join(chain_engines, " or "),
                          fmt::join(sheet_engines, " or ")));
}

/// --out for a flight, and how an animation lies in the shot.
void add_flight_out(CLI::App& command, std::string& out, AnimationOptions& animation) {
  add_out(command, out, "FILE",
          fmt::format("Result (JSON; - is standard output), or an animated mesh:\n"
                      "{}; numbered files have ####.obj",
                      fmt::join(animation_extensions, ", ")));
  const auto add_count = [&](const char* name, Index& into, const char* description) {
    command
        .add_option_function<std::string>(
            name,
            [name, &into](const std::string& text) { into = whole_number(name, text, 0, 1000000); },
            description)
        ->type_name("N")
        ->default_str(fmt::format("{}", into));
  };
  add_count("--first-frame", animation.first_frame, "Animation: number of its first frame");
  add_count("--hold-frames", animation.held_frames,
            "Animation: frames of the cloth as it is before the throw");
  command
      .add_option_function<std::string>(
          "--tail",
          [&animation](const std::string& text) {
            animation.tail = non_negative_number("--tail", text);
          },
          "Animation: free flight after the arrival [s], without control")
      ->type_name("S")
      ->default_str("0");
  command
      .add_option_function<std::string>(
          "--ribbon-width",
          [&animation](const std::string& text) {
            animation.ribbon_width = positive_number("--ribbon-width", text);
          },
          "Animation: width of a chain's ribbon [m], > 0; by default a tenth\n"
          "of its length")
      ->type_name("W");
}

/// A limit of the search, a number ≥ 0.
void add_limit(CLI::App& command, const char* name, std::optional<double>& limit,
               const char* description) {
  command
      .add_option_function<std::string>(
          name,
          [name, &limit](const std::string& text) { limit = non_negative_number(name, text); },
          description)
      ->type_name("X");
}

void add_refine(CLI::App& command, bool& refine) {
  command.add_flag("--refine", refine,
                   "Then turn the motion, and the launch along it, until the cloth\n"
                   "arrives on the target exactly, or as near as it can and is worth\n"
                   "it; a chain at the least effort. With a limit, as near as the\n"
                   "limit asks or lets. At a gain of its own; best with a damped\n"
                   "\"morph\", see below");
}

void add_error_limit(CLI::App& command, std::optional<double>& limit) {
  add_limit(command, "--error-limit", limit,
            "The gain of least control effort whose error is at most X\n"
            "of the cloth's length, instead of the one of least error");
}

void add_optimizer(CLI::App& command, OptimizeOptions& options) {
  command
      .add_option_function<std::string>(
          "--optimizer",
          [&options](const std::string& text) {
            options.search.optimizer = word("--optimizer", text, optimizer_names);
          },
          fmt::format("Search: {}", fmt::join(optimizer_names, " or ")))
      ->type_name("NAME")
      ->default_str(std::string(optimizer_names.front()));
  add_error_limit(command, options.search.error_limit);
  add_limit(command, "--effort-limit", options.search.effort_limit,
            "The gain of least error whose control effort is at most X");
}

void add_coefficients(CLI::App& command, Index& coefficients) {
  command
      .add_option_function<std::string>(
          "--coefficients",
          [&coefficients](const std::string& text) {
            coefficients = whole_number("--coefficients", text, 1, static_cast<int>(most_groups));
          },
          fmt::format("1 … {} gains, for the shape's waves from long to short, found\n"
                      "together from the best single gain on. Of a chain: up to {} half\n"
                      "waves along the cloth, the rest; with more gains up to {}, up to\n"
                      "{}. Of a sheet: its {} … {} longest waves, the rest; with more\n"
                      "gains up to {} … {}, up to {} … {} of them",
                      most_groups, last_mode_of_group[0], last_mode_of_group[1],
                      last_mode_of_group[2], last_modes_of_sheet_group[0].first,
                      last_modes_of_sheet_group[0].last, last_modes_of_sheet_group[1].first,
                      last_modes_of_sheet_group[1].last, last_modes_of_sheet_group[2].first,
                      last_modes_of_sheet_group[2].last))
      ->type_name("K")
      ->default_str(fmt::format("{}", coefficients));
}

void add_reverse_target(CLI::App& command, bool& reverses) {
  command.add_flag("--reverse-target", reverses,
                   "The cloth's first particle to the end of a drawn target, not to its\n"
                   "beginning");
}

}  // namespace

// The parser and the action share a command's options.

Action add_simulate(CLI::App& command) {
  const auto options = std::make_shared<SimulateOptions>();
  add_file(command, "SCENE", options->scene,
           "Scene file (JSON), or a result: flown again as it was, to the last bit");
  add_any_backend(command, options->backend);
  command.get_option("--backend")->default_str("native, or the result's");
  command
      .add_option_function<std::string>(
          "--alpha",
          [options](const std::string& text) { options->gains = gains("--alpha", text); },
          "Gain of the shape control [N/m], >= 0; 0 is launch only.\n"
          "A,B or A,B,C …: gains by group of modes, see optimize --coefficients")
      ->type_name("A")
      ->default_str("0, or the result's");
  add_time_step(command, options->changes.time_step);
  add_reverse_target(command, options->changes.reverses_target);
  add_flight_out(command, options->out, options->animation);
  command.footer(which_reference);
  return [options] { return simulate(*options); };
}

Action add_optimize(CLI::App& command) {
  const auto options = std::make_shared<OptimizeOptions>();
  add_file(command, "SCENE", options->scene, scene_file);
  add_any_backend(command, options->backend);
  add_optimizer(command, *options);
  add_coefficients(command, options->search.coefficients);
  add_refine(command, options->search.refine);
  command.add_flag("--robust", options->search.robust,
                   "Prefer a gain whose answer is not fragile: the error is the mean\n"
                   "over five starts, four of them perturbed by 0.1 % of the length");
  add_time_step(command, options->changes.time_step);
  add_reverse_target(command, options->changes.reverses_target);
  add_flight_out(command, options->out, options->animation);
  command.footer(which_reference);
  return [options] {
    require_compatible(options->search);
    return optimize(*options);
  };
}

Action add_throw(CLI::App& command) {
  const auto options = std::make_shared<ThrowOptions>();
  add_file(command, "START", options->start,
           "The cloth as it is: a mesh (.obj, .ply, .gltf, .glb), or a drawn line\n"
           "(.svg, .obj, .csv), FILE#ID where there are several");
  add_file(command, "TARGET", options->target,
           "The same mesh as it should be, or another line; FILE.glb#NAME is a\n"
           "shape key (morph target). May be left out where START has a single\n"
           "shape key, or two lines, initial and target");
  command.get_option("TARGET")->required(false);
  add_positive(command, "--time", "T", options->request.arrival_time, "Arrival time [s], > 0");
  command.get_option("--time")->required();
  add_flight_out(command, options->out, options->animation);
  command
      .add_option_function<std::string>(
          "--material",
          [options](const std::string& text) {
            if (!find_material(text)) {
              throw CLI::ValidationError(
                  "--material", fmt::format("\"{}\" is not one of {}", text, material_names()));
            }
            options->request.material = text;
          },
          fmt::format("Cloth of a mesh: {}", material_names()))
      ->type_name("M");
  add_any_backend(command, options->backend);
  add_positive(command, "--frames-per-second", "R", options->request.frames_per_second,
               "Frames of the animation [1/s], > 0");
  command.get_option("--frames-per-second")
      ->default_str(fmt::format("{}", options->request.frames_per_second));
  add_error_limit(command, options->error_limit);
  add_refine(command, options->refine);
  command.add_flag("--settle", options->request.settle, "The cloth comes to rest on the target");
  add_reverse_target(command, options->reverses_target);
  command.footer(
      "The cloth follows a motion from the first shape to the second, \"reference\": \"morph\"\n"
      "with \"damping_ratio\": 0.7 in a scene, at the gain of least error at arrival.");
  return [options] { return throw_cloth(*options); };
}

Action add_compare(CLI::App& command) {
  const auto options = std::make_shared<CompareOptions>();
  add_files(command, "SCENE", options->scenes, "Scene files, or folders of them (*.json)");
  add_out(command, options->out, "DIR",
          "Folder for compare.json; - is compare.json on standard output");
  command.footer(which_reference);
  return [options] { return compare(*options); };
}

Action add_batch(CLI::App& command) {
  const auto options = std::make_shared<BatchOptions>();
  add_files(command, "SHOT", options->shots, "Scene files, or folders of them (*.json)");
  add_out(command, options->out, "DIR",
          "Folder of the results, NAME.json of each shot NAME.json. Those that\n"
          "are there, and newer than their shot, stay as they are");
  command.get_option("--out")->required();
  add_any_backend(command, options->backend);
  command
      .add_option_function<std::string>(
          "--jobs",
          [options](const std::string& text) {
            options->jobs = whole_number("--jobs", text, 1, 1024);
          },
          "Shots at once, a core each; by default as many as there are cores")
      ->type_name("J");
  command
      .add_option_function<std::string>(
          "--part",
          [options](const std::string& text) {
            const std::size_t slash = text.find('/');
            if (slash == text.npos) {
              throw CLI::ValidationError("--part", fmt::format("\"{}\" is not I/N", text));
            }
            options->parts = whole_number("--part", text.substr(slash + 1), 1, 1'000'000);
            options->part =
                whole_number("--part", text.substr(0, slash), 1, static_cast<int>(options->parts));
          },
          "The I-th of N parts of the shots, 1 … N, for one of N jobs of a\n"
          "cluster; the summary is made by a run without it")
      ->type_name("I/N");
  command.footer(
      "Then DIR has summary.csv and report.html as well. A shot that is broken or diverges is\n"
      "told, and does not stop the others. An interrupted run goes on where it was.");
  return [options] { return throw_batch(*options); };
}

Action add_studio(CLI::App& command) {
  const auto options = std::make_shared<StudioOptions>();
  command
      .add_option_function<std::string>(
          "--port",
          [options](const std::string& text) {
            options->port = whole_number("--port", text, 0, 65535);
          },
          "Port of 127.0.0.1; if it is taken, or 0, any free one")
      ->type_name("P")
      ->default_str(fmt::format("{}", options->port));
  command.add_flag_callback(
      "--no-open", [options] { options->opens_browser = false; }, "Do not open the browser");
  return [options] {
    serve_studio(*options);
    return ExitStatus::done;
  };
}

Action add_figures(CLI::App& command) {
  const auto options = std::make_shared<FiguresOptions>();
  add_out(command, options->out, "DIR", "Folder for figure-5 … figure-8, SVG and PNG");
  command.get_option("--out")->default_str(options->out);
  return [options] { return make_figures(*options); };
}

Action add_render(CLI::App& command) {
  const auto options = std::make_shared<RenderOptions>();
  add_files(command, "RESULT", options->results,
            "Result files, overlaid; a scene file is thrown at its best gain");
  add_out(command, options->out, "FILE",
          fmt::format("File that ends in {}", fmt::join(render_extensions, ", ")));
  command.get_option("--out")->required();
  command.add_flag("--still", options->still, "An SVG that does not move");
  command.add_flag("--plain", options->plain, "The shapes alone: no axes, no text");
  add_positive(command, "--speed", "S", options->speed,
               "Speed of what moves over that of the flight, > 0");
  command.get_option("--speed")->default_str(fmt::format("{}", options->speed));
  return [options] { return render(*options); };
}

}  // namespace nuno
