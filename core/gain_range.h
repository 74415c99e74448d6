#pragma once

#include <nuno/optimize.h>

namespace nuno {

/// φ² up to which E(α) of a control without damping is calm, whatever the scene: it swings 1½ times
/// until arrival.
inline constexpr double calm_gain_scales = 100;

/// Whether control has too little damping for its swings to die before arrival.
inline bool swings(const Objective& objective) { return objective.damping_ratio < 0.5; }

/// How far a radian more of phase φ = √(α/gain_scale) moves the arrival, over the cloth's size;
/// +∞ where the flight diverged. Some tenths are the offsets from the reference that swing; above
/// 1, a flight says nothing of its neighbours and E is noise.
double swing_speed(const Objective& objective, double gain, const ErrorSample& sample);

}  // namespace nuno
