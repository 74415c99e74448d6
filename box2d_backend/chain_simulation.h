#pragma once

#include <nuno/mass_center_flight.h>

#include "rod_chain.h"

#include <memory>

namespace nuno::box2d {

/// How a chain is stepped, see chain_simulation.cpp.
struct Scheme {
  double keep = 1;         ///< s
  double half_kick = 0.5;  ///< q
  int velocity_iterations = 0;
  int position_iterations = 0;
};

Scheme make_scheme(const RodChain& chain, const Options& options);

/// A flight of a chain, which with its scheme has to outlive it, about this flight of its mass
/// centre.
std::unique_ptr<Simulation> make_simulation(const RodChain& chain, const Scheme& scheme,
                                            const MassCenterFlight& center, const Points& positions,
                                            const Points& velocities);

}  // namespace nuno::box2d
