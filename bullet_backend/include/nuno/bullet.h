#pragma once

#include <nuno/backend.h>

#include <memory>

namespace nuno::bullet {

/// The same cloth as a soft body of Bullet's deformable world, in single precision: its nodes fly
/// about their mass centre, whose own flight is known. Stretch, shear, bending, drag and control
/// are forces of their own kinds in that world.
///
/// The time step, the problem's or 1/2000 of the arrival time, is cut to what is stable for
/// springs, hinges and their dashpots in whatever shape the sheet gets into, to half a size L of
/// launch about the mass centre, and to a whole number of steps.
///
/// A cloth whose particles move by more than L a step about the mass centre has diverged: its
/// positions are NaN from then on. Throws InputError for a problem without a sheet and for a step
/// that would make more than most_steps.
std::unique_ptr<Backend> make_backend(const Problem& problem);

}  // namespace nuno::bullet
