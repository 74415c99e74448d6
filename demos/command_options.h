#pragma once

#include <CLI/App.hpp>

#include <functional>

#include "commands.h"

namespace nuno {

/// A command with its options, to be called once the command line is parsed. Throws
/// CLI::ValidationError where two options do not go together.
using Action = std::function<ExitStatus()>;

// Each adds one command's options to its part of the command line.
Action add_simulate(CLI::App& command);
Action add_optimize(CLI::App& command);
Action add_throw(CLI::App& command);
Action add_compare(CLI::App& command);
Action add_batch(CLI::App& command);
Action add_studio(CLI::App& command);
Action add_figures(CLI::App& command);
Action add_render(CLI::App& command);

}  // namespace nuno
