#pragma once

#include <nuno/mass_center_flight.h>

#include "unit_sheet.h"

#include <memory>

namespace nuno::bullet {

/// A flight of a sheet, which has to outlive it, about this flight of its mass centre.
std::unique_ptr<Simulation> make_simulation(const UnitSheet& sheet, const MassCenterFlight& center,
                                            const Points& positions, const Points& velocities);

}  // namespace nuno::bullet
