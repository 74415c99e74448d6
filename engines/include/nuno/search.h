#pragma once

#include <nuno/engines.h>
#include <nuno/result_file.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace nuno {

/// What is asked of the search for the gain at which to fly.
struct SearchOptions {
  std::optional<std::string> optimizer;  ///< one of optimizer_names; absent: the first
  /// Least effort within this error, over the cloth's length; takes the optimiser's place.
  std::optional<double> error_limit;
  /// Least error within this control effort; takes the optimiser's place.
  std::optional<double> effort_limit;
  Index coefficients = 1;  ///< gains by group of modes, 1 … most_groups
  bool refine = false;     ///< corrects the reference until the cloth is on the target
  bool robust = false;     ///< the error averaged over small perturbations of the start
};

/// Throws InputError, which names an option as the program does, where two do not go together.
void require_compatible(const SearchOptions& options);

/// What a search found, ready to be flown.
struct SearchAnswer {
  Optimization how;
  Gains gains = 0;                        ///< α of every group [N/m]
  std::unique_ptr<Backend> backend = {};  ///< of the problem as it was given, or corrected
  bool left_refinement_out = false;  ///< it was asked for, and was no better than the gain alone
};

/// Whether people are told on standard error, see progress.h.
enum class Telling { silent, progress };

/// Searches the gain that the options ask for of a scene on `backend`, which is the engine of its
/// problem. Where every rollout diverged, the one at the gain that is returned says why.
SearchAnswer search(const SceneFile& file, std::unique_ptr<Backend> backend,
                    const SearchOptions& options, Telling telling = Telling::silent);

}  // namespace nuno
