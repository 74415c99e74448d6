#pragma once

#include <nuno/backend.h>

#include <string>

namespace nuno {

/// How far edges of a sheet's target differ from their rest lengths, at worst.
struct EdgeMismatch {
  double too_long = 0;   ///< largest target length / rest length − 1, or 0
  double too_short = 0;  ///< largest 1 − target length / rest length, or 0
};

/// What a throw asks of the cloth, known before any flight.
struct Feasibility {
  double length_mismatch = 0;    ///< largest |target edge / rest length − 1|
  bool is_sheet = false;         ///< which the next three are of
  EdgeMismatch border, inside;   ///< edges of one face, and of two
  double folding = 0;            ///< largest change of the angle between two triangles [rad]
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
