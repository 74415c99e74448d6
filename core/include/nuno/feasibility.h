#pragma once

#include <nuno/backend.h>

#include <string>

namespace nuno {

/// What a throw asks of the cloth, known before any flight.
struct Feasibility {
  double length_mismatch = 0;    ///< largest |target segment / rest length − 1|
  double launch_speed = 0;       ///< of the fastest particle [m/s]
  double launch_stretching = 0;  ///< fastest change of a segment's length at launch, over it [1/s]
  double launch_strain = 0;      ///< about what strain that makes before the thread pulls it back
  double turning = 0;            ///< largest turn of a segment relative to the whole [rad]
  double time_step = 0;          ///< [s]
  Index steps = 0;
};

Feasibility assess(const Backend& backend);

/// The verdict in words, a sentence for each thing that stands in the way; empty if nothing does.
std::string verdict(const Feasibility& feasibility);

}  // namespace nuno
