#pragma once

#include <nuno/optimize.h>

#include <span>

namespace nuno {

/// Searches all valleys between `gains`, which ascend, at once, with the objective's derivatives.
/// Adds what it tried to the summary's history and evaluations. False where the rounds ran out
/// before the end.
bool search_with_derivatives(const Objective& objective, std::span<const double> gains,
                             const GlobalSearchOptions& options, OptimizeSummary& summary);

}  // namespace nuno
