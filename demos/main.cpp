// The command line of the program `nuno`: options in, exit status out.

#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <nuno/scene.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include <nuno/engines.h>
#include <nuno/materials.h>
#include <nuno/output.h>
#include "commands.h"
#include "studio/studio.h"

namespace nuno {
namespace {

/// A number of the command line, to its last bit. Throws CLI::ValidationError.
double number(const std::string& option, const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) {
    throw CLI::ValidationError(option, fmt::format("\"{}\" is not a finite number", text));
  }
  return value + 0.0;  // -0 is 0
}

std::string word(const std::string& option, const std::string& text,
                 std::span<const std::string_view> words) {
  if (std::ranges::find(words, text) == words.end()) {
    throw CLI::ValidationError(
        option, fmt::format("\"{}\" is not one of {}", text, fmt::join(words, ", ")));
  }
  return text;
}

std::string not_empty(const std::string& option, const std::string& text) {
  if (text.empty()) throw CLI::ValidationError(option, "\"\" is not a name");
  return text;
}

/// Numbers ≥ 0 with commas between them, a gain for every group.
Gains gains(const std::string& option, const std::string& text) {
  std::vector<double> groups;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::string part = text.substr(start, end - start);
    groups.push_back(number(option, part));
    if (!(groups.back() >= 0)) {
      throw CLI::ValidationError(option, fmt::format("{} is not >= 0", part));
    }
    start = end + 1;
  }
  if (static_cast<Index>(groups.size()) > most_groups) {
    throw CLI::ValidationError(option,
                               fmt::format("\"{}\" is more than {} gains", text, most_groups));
  }
  return Gains::of_groups(groups);
}

void add_scene(CLI::App& command, std::string& scene) {
  command
      .add_option_function<std::string>(
          "SCENE", [&](const std::string& text) { scene = not_empty("SCENE", text); },
          "Scene file (JSON)")
      ->type_name("")
      ->required();
}

void add_backend(CLI::App& command, std::string& backend) {
  command
      .add_option_function<std::string>(
          "--backend",
          [&](const std::string& text) { backend = word("--backend", text, backend_names); },
          fmt::format("Engine: {} for chains, {} for sheets", fmt::join(chain_engines, " or "),
                      fmt::join(sheet_engines, " or ")))
      ->type_name("NAME")
      ->default_str(backend);
}

void add_time_step(CLI::App& command, std::optional<double>& time_step) {
  command
      .add_option_function<std::string>(
          "--time-step",
          [&](const std::string& text) {
            time_step = number("--time-step", text);
            if (!(*time_step > 0)) {
              throw CLI::ValidationError("--time-step", fmt::format("{} is not > 0", text));
            }
          },
          "Time step [s], > 0; by default the scene's or the engine's")
      ->type_name("H");
}

void add_out(CLI::App& command, std::string& out, const char* type, const char* description) {
  command
      .add_option_function<std::string>(
          "--out", [&](const std::string& text) { out = not_empty("--out", text); }, description)
      ->type_name(type);
}

/// An option whose value is a number > 0.
void add_positive(CLI::App& command, const char* name, const char* type, double& into,
                  const char* description) {
  command
      .add_option_function<std::string>(
          name,
          [name, &into](const std::string& text) {
            into = number(name, text);
            if (!(into > 0)) throw CLI::ValidationError(name, fmt::format("{} is not > 0", text));
          },
          description)
      ->type_name(type);
}

void add_file(CLI::App& command, const char* name, std::string& into, const char* description) {
  command
      .add_option_function<std::string>(
          name, [name, &into](const std::string& text) { into = not_empty(name, text); },
          description)
      ->type_name("")
      ->required();
}

void add_throw_options(CLI::App& command, ThrowOptions& options) {
  add_file(command, "START", options.start, "Mesh of the cloth as it is (.obj)");
  add_file(command, "TARGET", options.target, "The same mesh as it should be (.obj)");
  add_positive(command, "--time", "T", options.arrival_time, "Arrival time [s], > 0");
  command.get_option("--time")->required();
  add_out(command, options.out, "FILE",
          "Animated mesh (.glb) or result (.json; - is standard output)");
  command
      .add_option_function<std::string>(
          "--material",
          [&](const std::string& text) {
            if (!find_material(text)) {
              throw CLI::ValidationError(
                  "--material", fmt::format("\"{}\" is not one of {}", text, material_names()));
            }
            options.material = text;
          },
          fmt::format("Cloth: {}", material_names()))
      ->type_name("M");
  command
      .add_option_function<std::string>(
          "--backend",
          [&](const std::string& text) {
            options.backend = word("--backend", text, sheet_engines);
          },
          fmt::format("Engine: {}", fmt::join(sheet_engines, " or ")))
      ->type_name("NAME")
      ->default_str(options.backend);
  add_positive(command, "--frames-per-second", "R", options.frames_per_second,
               "Frames of the animation [1/s], > 0");
  command.get_option("--frames-per-second")
      ->default_str(fmt::format("{}", options.frames_per_second));
  command.add_flag("--settle", options.settle, "The cloth comes to rest on the target");
  command.footer(
      "The cloth follows a motion from the first shape to the second, \"reference\": \"morph\"\n"
      "with \"damping_ratio\": 0.7 in a scene, at the gain of least error at arrival.");
}

constexpr const char* commands = "Commands";  // their heading in the help
constexpr const char* out_file =
    "Result (JSON; - is standard output), or of a sheet an animated mesh (.glb)";

// Below the options of every command that throws scenes.
constexpr const char* which_reference = R"(What the control pulls towards is the scene's choice:
  "reference": "hold"    The target's shape from the first step on, as in the paper;
                         the default. To see the paper's method: it is near at few
                         gains only, and often fragile there.
  "reference": "morph"   A motion from the initial shape to the target. For all else:
                         nearer, calmer, at a fraction of the force.
  "damping_ratio": 0.7   With "morph": what swings about that motion dies away, and
                         more gain is less error. 0, the default, is the paper's.
  "arrival": "pass"      With "morph": in full swing, to fly on; the default.
  "arrival": "settle"    With "morph": the shape comes to rest, to be held or to be
                         looked at; takes a little more force.)";

ExitStatus fail(ExitStatus status, const std::string& message) {
  complain(message);
  return status;
}

/// What was wrong with the command line, in the words of all our messages.
std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  std::string what = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
    const std::string extra = app.remaining(true).front();
    if (extra.starts_with("-")) return fmt::format("{}: is not a known option", extra);
    if (app.get_subcommands().empty()) {
      std::vector<std::string> names;
      for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
      }
      return fmt::format("nuno: \"{}\" is not one of {}", extra, fmt::join(names, ", "));
    }
    return fmt::format("\"{}\": is one argument too many", extra);
  }
  if (dynamic_cast<const CLI::RequiredError*>(&error)) {
    return what.substr(0, what.find(' ')) + ": is missing; it is required";
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
    return what.substr(0, what.find(':')) + ": takes exactly one value";
  }
  return what;
}

/// Throws for a flag with a value: CLI11 would let some pass.
void require_bare_flags(const CLI::App& app, int argc, char** argv) {
  std::vector<const CLI::App*> apps = app.get_subcommands([](const CLI::App*) { return true; });
  apps.push_back(&app);
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::string name = argument.substr(0, argument.find('='));
    if (name.size() == argument.size() || !name.starts_with("-")) continue;
    for (const CLI::App* each : apps) {
      const CLI::Option* option = each->get_option_no_throw(name);
      if (option && option->get_items_expected_max() == 0) {
        throw CLI::ValidationError(name, "takes no value");
      }
    }
  }
}

ExitStatus run(int argc, char** argv) {
  CLI::App app("Throws a cloth so that it arrives at a drawn target: in place, in shape, on time.",
               "nuno");
  app.set_version_flag("--version", "nuno " NUNO_VERSION, "Print the version and exit");
  app.set_help_flag("--help,-h", "Print this help and exit");
  app.footer(
      "Exit status: 0 done; 1 an output cannot be written; 2 bad usage or a bad scene;\n"
      "3 the simulation diverged. 'nuno COMMAND --help' tells a command's options.");
  app.require_subcommand(0, 1);  // one command line is one command
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.get_formatter()->label("Positionals", "Arguments");
  app.get_formatter()->label("REQUIRED", "");
  std::function<ExitStatus()> chosen;

  SimulateOptions simulation;
  CLI::App& simulate_command = *app.add_subcommand("simulate", "Throw the cloth once, at one gain");
  add_scene(simulate_command, simulation.scene);
  add_backend(simulate_command, simulation.backend);
  simulate_command
      .add_option_function<std::string>(
          "--alpha", [&](const std::string& text) { simulation.gains = gains("--alpha", text); },
          "Gain of the shape control [N/m], >= 0; 0 is launch only.\n"
          "A,B or A,B,C …: gains by group of modes, see optimize --coefficients")
      ->type_name("A")
      ->default_str(fmt::format("{}", simulation.gains.rest));
  add_time_step(simulate_command, simulation.time_step);
  add_out(simulate_command, simulation.out, "FILE", out_file);
  simulate_command.footer(which_reference);
  simulate_command.group(commands);
  simulate_command.callback([&] { chosen = [&] { return simulate(simulation); }; });

  OptimizeOptions optimization;
  CLI::App& optimize_command =
      *app.add_subcommand("optimize", "Find the gain with the smallest error at arrival");
  add_scene(optimize_command, optimization.scene);
  add_backend(optimize_command, optimization.backend);
  optimize_command
      .add_option_function<std::string>(
          "--optimizer",
          [&](const std::string& text) {
            optimization.optimizer = word("--optimizer", text, optimizer_names);
          },
          fmt::format("Search: {}", fmt::join(optimizer_names, " or ")))
      ->type_name("NAME")
      ->default_str(optimization.optimizer);
  const auto add_limit = [&](const char* name, std::optional<double>& limit,
                             const char* description) {
    optimize_command
        .add_option_function<std::string>(
            name,
            [name, &limit](const std::string& text) {
              limit = number(name, text);
              if (!(*limit >= 0)) {
                throw CLI::ValidationError(name, fmt::format("{} is not >= 0", text));
              }
            },
            description)
        ->type_name("X");
  };
  add_limit("--error-limit", optimization.error_limit,
            "The gain of least control effort whose error is at most X\n"
            "of the cloth's length, instead of the one of least error");
  add_limit("--effort-limit", optimization.effort_limit,
            "The gain of least error whose control effort is at most X");
  optimize_command
      .add_option_function<std::string>(
          "--coefficients",
          [&](const std::string& text) {
            const double count = number("--coefficients", text);
            if (!(count >= 1 && count <= most_groups && count == std::floor(count))) {
              throw CLI::ValidationError(
                  "--coefficients",
                  fmt::format("{} is not a whole number within 1 … {}", text, most_groups));
            }
            optimization.coefficients = static_cast<Index>(count);
          },
          fmt::format("1 … {} gains, for the shape's waves from long to short, found\n"
                      "together from the best single gain on: up to {} half waves along\n"
                      "the cloth, the rest; with more gains up to {}, up to {}",
                      most_groups, last_mode_of_group[0], last_mode_of_group[1],
                      last_mode_of_group[2]))
      ->type_name("K")
      ->default_str(fmt::format("{}", optimization.coefficients));
  optimize_command.add_flag("--refine", optimization.refine,
                            "Then turn the motion, and the launch along it, until the cloth\n"
                            "arrives on the target at the least effort; with a limit, as\n"
                            "near as the limit asks or lets. At a gain of its own; best\n"
                            "with a damped \"morph\", see below");
  optimize_command.add_flag("--robust", optimization.robust,
                            "Prefer a gain whose answer is not fragile: the error is the mean\n"
                            "over five starts, four of them perturbed by 0.1 % of the length");
  add_time_step(optimize_command, optimization.time_step);
  add_out(optimize_command, optimization.out, "FILE", out_file);
  optimize_command.footer(which_reference);
  optimize_command.group(commands);
  optimize_command.callback([&] {
    if (optimization.error_limit && optimization.effort_limit) {
      throw CLI::ValidationError("--effort-limit", "does not go with --error-limit");
    }
    if (optimize_command.count("--optimizer") > 0 &&
        (optimization.error_limit || optimization.effort_limit)) {
      throw CLI::ValidationError("--optimizer", "does not go with a limit");
    }
    if (optimization.robust && (optimization.error_limit || optimization.effort_limit)) {
      throw CLI::ValidationError("--robust", "does not go with a limit");
    }
    if (optimization.coefficients > 1 &&
        (optimization.robust || optimization.error_limit || optimization.effort_limit)) {
      throw CLI::ValidationError("--coefficients", "does not go with --robust or a limit");
    }
    if (optimization.refine && (optimization.robust || optimization.coefficients > 1)) {
      throw CLI::ValidationError(
          "--refine", "does not go with --coefficients or --robust, it has a gain of its own");
    }
    chosen = [&] { return optimize(optimization); };
  });

  ThrowOptions throwing;
  CLI::App& throw_command = *app.add_subcommand(
      "throw", "Throw a mesh so that it arrives as another pose of itself, as an animated mesh");
  add_throw_options(throw_command, throwing);
  throw_command.group(commands);
  throw_command.callback([&] { chosen = [&] { return throw_cloth(throwing); }; });

  CompareOptions comparison;
  CLI::App& compare_command =
      *app.add_subcommand("compare", "Both engines on the same scenes, side by side");
  compare_command
      .add_option_function<std::vector<std::string>>(
          "SCENE",
          [&](const std::vector<std::string>& texts) {
            for (const auto& text : texts) comparison.scenes.push_back(not_empty("SCENE", text));
          },
          "Scene files, or folders of them (*.json)")
      ->type_name("")
      ->required();
  add_out(compare_command, comparison.out, "DIR",
          "Folder for compare.json; - is compare.json on standard output");
  compare_command.footer(which_reference);
  compare_command.group(commands);
  compare_command.callback([&] { chosen = [&] { return compare(comparison); }; });

  StudioOptions studio_options;
  CLI::App& studio_command =
      *app.add_subcommand("studio", "Draw both shapes in the browser, throw, watch");
  studio_command
      .add_option_function<std::string>(
          "--port",
          [&](const std::string& text) {
            const double port = number("--port", text);
            if (!(port >= 0 && port <= 65535 && port == std::floor(port))) {
              throw CLI::ValidationError(
                  "--port", fmt::format("{} is not a whole number within 0 … 65535", text));
            }
            studio_options.port = static_cast<int>(port);
          },
          "Port of 127.0.0.1; if it is taken, or 0, any free one")
      ->type_name("P")
      ->default_str(fmt::format("{}", studio_options.port));
  studio_command.add_flag_callback(
      "--no-open", [&] { studio_options.opens_browser = false; }, "Do not open the browser");
  studio_command.group(commands);
  studio_command.callback([&] {
    chosen = [&] {
      serve_studio(studio_options);
      return ExitStatus::done;
    };
  });

  FiguresOptions pictures;
  CLI::App& figures_command =
      *app.add_subcommand("figures", "The paper's figures 5 to 8, from runs of our own");
  add_out(figures_command, pictures.out, "DIR", "Folder for figure-5 … figure-8, SVG and PNG");
  figures_command.get_option("--out")->default_str(pictures.out);
  figures_command.group(commands);
  figures_command.callback([&] { chosen = [&] { return make_figures(pictures); }; });

  RenderOptions rendering;
  CLI::App& render_command = *app.add_subcommand("render", "Results as a picture or a film");
  render_command
      .add_option_function<std::vector<std::string>>(
          "RESULT",
          [&](const std::vector<std::string>& texts) {
            for (const auto& text : texts) rendering.results.push_back(not_empty("RESULT", text));
          },
          "Result files, overlaid; a scene file is thrown at its best gain")
      ->type_name("")
      ->required();
  add_out(render_command, rendering.out, "FILE",
          fmt::format("File that ends in {}", fmt::join(render_extensions, ", ")).c_str());
  render_command.get_option("--out")->required();
  render_command.add_flag("--still", rendering.still, "An SVG that does not move");
  render_command.add_flag("--plain", rendering.plain, "The shapes alone: no axes, no text");
  render_command
      .add_option_function<std::string>(
          "--speed",
          [&](const std::string& text) {
            rendering.speed = number("--speed", text);
            if (!(rendering.speed > 0)) {
              throw CLI::ValidationError("--speed", fmt::format("{} is not > 0", text));
            }
          },
          "Speed of what moves over that of the flight, > 0")
      ->type_name("S")
      ->default_str(fmt::format("{}", rendering.speed));
  render_command.group(commands);
  render_command.callback([&] { chosen = [&] { return render(rendering); }; });

  try {
    require_bare_flags(app, argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {
    app.exit(wish);  // prints the help or the version
    return ExitStatus::done;
  } catch (const CLI::ParseError& error) {
    return fail(ExitStatus::bad_input, explain(app, error));
  }
  if (!chosen) return fail(ExitStatus::bad_input, "nuno: a command is missing; see nuno --help");
  return chosen();
}

/// Runs the program and says what went wrong, if anything did.
ExitStatus run_and_complain(int argc, char** argv) {
  try {
    const ExitStatus status = run(argc, argv);
    require_standard_output_written();
    return status;
  } catch (const InputError& error) {
    return fail(ExitStatus::bad_input, error.what());
  } catch (const OutputError& error) {
    return fail(ExitStatus::unwritable, error.what());
  } catch (const std::system_error& error) {  // fmt::print's, where nothing takes the text
    return fail(ExitStatus::unwritable, error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitStatus::bad_input, "the scene needs more memory than there is");
  }
}

}  // namespace
}  // namespace nuno

int main(int argc, char** argv) {
  nuno::handle_signals();
  // Where standard input is closed, a file of ours would get its number, and a program that we run
  // would read it.
  if (fcntl(STDIN_FILENO, F_GETFD) < 0) open("/dev/null", O_RDONLY);
  try {
    return static_cast<int>(nuno::run_and_complain(argc, argv));
  } catch (...) {  // not even the complaint could be written
    return static_cast<int>(nuno::ExitStatus::unwritable);
  }
}
