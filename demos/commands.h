#pragma once

#include <optional>
#include <string>
#include <vector>

namespace nuno {

/// What the program's exit status says.
enum class ExitStatus {
  done = 0,
  unwritable = 1,  ///< an output cannot be written
  bad_input = 2,   ///< bad usage or a bad scene
  diverged = 3     ///< the simulation diverged
};

/// One rollout at one gain.
struct SimulateOptions {
  std::string scene;                ///< a file
  std::string backend = "native";   ///< one of backend_names
  double gain = 0;                  ///< α ≥ 0 [N/m]; 0 is launch only
  std::optional<double> time_step;  ///< [s], > 0; absent: the scene's
  std::string out;                  ///< result file, "-" for standard output, empty for none
};

/// The search for the best gain.
struct OptimizeOptions {
  std::string scene;                 ///< a file
  std::string backend = "native";    ///< one of backend_names
  std::string optimizer = "global";  ///< one of optimizer_names
  std::optional<double> time_step;   ///< [s], > 0; absent: the scene's
  std::string out;                   ///< result file, "-" for standard output, empty for none
};

/// Both engines on the same scenes.
struct CompareOptions {
  std::vector<std::string> scenes;  ///< files, and folders of *.json
  std::string out;                  ///< folder, "-" for compare.json on standard output, or none
};

/// The page on which both shapes are drawn.
struct StudioOptions {
  int port = 8471;            ///< of 127.0.0.1, 0 … 65535; 0, or one that is taken: any free one
  bool opens_browser = true;  ///< where there is a desktop
};

// The commands. They throw InputError and OutputError, and say themselves why a rollout diverged.
ExitStatus simulate(const SimulateOptions& options);
ExitStatus optimize(const OptimizeOptions& options);
ExitStatus compare(const CompareOptions& options);
ExitStatus serve_studio(const StudioOptions& options);

}  // namespace nuno
