#pragma once

#include <nuno/backend.h>

#include "unit_sheet.h"

#include <memory>

namespace nuno::bullet {

/// A flight of a sheet, which has to outlive it.
std::unique_ptr<Simulation> make_simulation(const UnitSheet& sheet, const Points& positions,
                                            const Points& velocities);

}  // namespace nuno::bullet
