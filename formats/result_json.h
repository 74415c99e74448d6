#pragma once

#include <nuno/crossings.h>
#include <nuno/optimize.h>
#include <nuno/refine.h>
#include <nuno/rollout.h>

#include <string>

#include <nlohmann/json.hpp>

// What a result says wherever it is told, in a file and by the studio.

namespace nuno {

/// What was flown, on which engine and in which steps, and how it arrived, at what effort. For a
/// rollout that has not diverged.
nlohmann::ordered_json result_head(const std::string& scene, const Backend& backend,
                                   const Rollout& rollout);

/// How the gain was searched; without the history.
nlohmann::ordered_json search_head(const std::string& optimizer, const OptimizeSummary& summary);

/// The gains tried and their errors; without those that diverged, which have no error to note.
nlohmann::ordered_json history_of(const OptimizeSummary& summary);

/// Where a sheet passes through itself or the ground, of a rollout that kept frames.
nlohmann::ordered_json crossings_head(const FlightCrossings& crossings);

/// How refinement ended, and what it took.
nlohmann::ordered_json refinement_head(const RefineSummary& refinement);

/// The word for how a search ended.
std::string_view word_for(OptimizeStatus status);

}  // namespace nuno
