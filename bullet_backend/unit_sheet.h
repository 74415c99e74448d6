#pragma once

#include <nuno/problem.h>

namespace nuno::bullet {

// Inside, the unit of length is the sheet's size L, of mass the mean particle's, of time a step:
// Bullet's own constants are in proportion whatever the scene's scale.

/// v ← keep·v + kick·a: what drag and a constant acceleration make of the mean velocity over a
/// step in the next.
struct Kick {
  double keep = 1;
  double kick = 1;
};

/// A sheet in those units, and how it is stepped; the same for every flight.
struct UnitSheet {
  double h = 0;            ///< the unit of time [s]
  double unit_length = 0;  ///< L [m]
  double unit_force = 0;   ///< [N]
  Vector mass;             ///< [N], mean 1
  Springs springs;         ///< stretch and shear
  Hinges hinges;
  Kick first;  ///< of the first step, which starts at a velocity and not half a step before
  Kick other;
};

UnitSheet make_unit_sheet(const Sheet& sheet, double h);

}  // namespace nuno::bullet
