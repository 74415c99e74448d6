#pragma once

#include <nuno/refine.h>

#include <chrono>

namespace nuno {

// Why a refinement ended, for people.
inline constexpr const char* arrived = "arrived within the tolerance";
inline constexpr const char* too_much_effort = "no flight of so little effort was found";
inline constexpr const char* no_more_effort = "more would take more effort than the limit";

/// Out of reach, an error of 1e-4·L is worth a particle's weight and no more: what 1·L of error
/// counts over an effort of one weight.
inline constexpr double worth_of_error = 1e4;

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The flight that a refinement starts from, with the problem's own reference correction.
RefineSummary first_flight(const Problem& problem, double gain, const MakeBackend& make,
                           const RefineOptions& options);

/// Whether the target's edges are as long as the cloth's. A cloth can be squeezed towards another
/// target without end.
bool is_within_reach(const Problem& problem, const MakeBackend& make);

/// Says whether the flight arrived, within what was allowed.
void conclude(RefineSummary& summary, double tolerance, double effort_limit);

/// `refine` of a sheet, see there.
RefineSummary refine_sheet(const Problem& problem, double gain, const MakeBackend& make,
                           const RefineOptions& options);

}  // namespace nuno
