#pragma once

#include <nuno/backend.h>

#include <vector>

namespace nuno::studio {

/// A flight to be looked at: frames with the control forces, and how it goes on after arrival.
struct Flight {
  std::vector<double> times;      ///< [s]
  std::vector<Points> positions;  ///< [d × N] each, m
  std::vector<Points> forces;     ///< of the shape control [d × N] each, N; none after arrival
};

/// The flight that `rollout` measures, at `frames` equal intervals until arrival, and for `after`
/// seconds more in which nothing controls the cloth. Ends early where it diverges.
Flight fly(const Backend& backend, const Gains& gains, Index frames, double after);

}  // namespace nuno::studio
