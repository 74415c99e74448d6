// The command line of the program `nuno`: options in, exit status out.

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <nuno/output.h>
#include <nuno/scene.h>

#include <array>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "arguments.h"
#include "command_options.h"

namespace nuno {
namespace {

/// What the program can do, in the order of its help.
struct Command {
  const char* name;
  const char* description;
  Action (*add)(CLI::App&);
};
constexpr std::array<Command, 8> commands = {{
    {"simulate", "Throw the cloth once, at one gain", add_simulate},
    {"optimize", "Find the gain with the smallest error at arrival", add_optimize},
    {"throw", "Throw a mesh or a drawn line so that it arrives as another shape of itself",
     add_throw},
    {"compare", "Both engines on the same scenes, side by side", add_compare},
    {"batch", "Throw many scenes, each at its best gain", add_batch},
    {"studio", "Draw both shapes in the browser, throw, watch", add_studio},
    {"figures", "The paper's figures 5 to 8, from runs of our own", add_figures},
    {"render", "Results as a picture or a film", add_render},
}};

ExitStatus fail(ExitStatus status, const std::string& message) {
  complain(message);
  return status;
}

void describe(CLI::App& app) {
  app.set_version_flag("--version", "nuno " NUNO_VERSION "\nbuilt with " NUNO_BUILT_WITH,
                       "Print the version, and what it was built with, and exit");
  app.set_help_flag("--help,-h", "Print this help and exit");
  app.footer(
      "Exit status: 0 done; 1 an output cannot be written; 2 bad usage or a bad scene;\n"
      "3 the simulation diverged. 'nuno COMMAND --help' tells a command's options.");
  app.require_subcommand(0, 1);  // one command line is one command
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.get_formatter()->label("Positionals", "Arguments");
  app.get_formatter()->label("REQUIRED", "");
}

ExitStatus run(int argc, char** argv) {
  CLI::App app("Throws a cloth so that it arrives at a drawn target: in place, in shape, on time.",
               "nuno");
  describe(app);
  std::vector<std::pair<const CLI::App*, Action>> actions;
  for (const Command& each : commands) {
    CLI::App& command = *app.add_subcommand(each.name, each.description)->group("Commands");
    actions.emplace_back(&command, each.add(command));
  }
  try {
    require_bare_flags(app, argc, argv);
    app.parse(argc, argv);
    for (const auto& [command, action] : actions) {
      if (command->parsed()) return action();
    }
  } catch (const CLI::Success& wish) {
    app.exit(wish);  // prints the help or the version
    return ExitStatus::done;
  } catch (const CLI::ParseError& error) {
    return fail(ExitStatus::bad_input, explain(app, error));
  }
  return fail(ExitStatus::bad_input, "nuno: a command is missing; see nuno --help");
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
