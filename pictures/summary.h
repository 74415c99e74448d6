#pragma once

#include <nuno/crossings.h>
#include <nuno/rollout.h>

#include <cstdio>
#include <string>

namespace nuno {

/// A time that a person reads: "4.1 ms", "1.25 s", "3 min 20 s".
std::string duration(double seconds);

/// What control effort is measured in, for people.
std::string effort_unit_name(const Cloth& cloth);

/// Where a sheet passes through itself or the ground, for people; `size` is its L.
std::string crossing_words(const FlightCrossings& crossings, double size);

/// A few lines for people on what a rollout did, and whether its answer is fragile.
void print_summary(std::FILE* file, const std::string& scene, const Backend& backend,
                   const Rollout& rollout, double sensitivity);

}  // namespace nuno
