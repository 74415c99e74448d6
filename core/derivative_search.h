#pragma once

#include <nuno/optimize.h>

#include <span>

namespace nuno {

/// Searches between `gains`, which ascend, with the objective's derivatives: all valleys at once, a
/// batch a round. Adds what it tried to the summary's history and evaluations. Whether it came to
/// an end before the rounds ran out.
bool search_with_derivatives(const Objective& objective, std::span<const double> gains,
                             const GlobalSearchOptions& options, OptimizeSummary& summary);

}  // namespace nuno
