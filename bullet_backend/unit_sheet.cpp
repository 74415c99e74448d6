#include "unit_sheet.h"

#include <cmath>

namespace nuno::bullet {
namespace {

// Under a constant acceleration a and drag κ the velocity at time t is
//     v(t) = e^(−κt)·v₀ + (1 − e^(−κt))/κ·a,
// and its mean u over each step of 1, with φ = (1 − e^(−κ))/κ,
//     u₁ = φ·v₀ + (1 − φ)/κ·a,    uₙ₊₁ = e^(−κ)·uₙ + φ·a.
// Exact for drag and gravity, and without drag the leapfrog: a half kick, then whole ones.
void set_kicks(double z, UnitSheet& unit) {
  constexpr double small = 1e-3;  // where the series below is exact to rounding
  const double mean = z > 0 ? -std::expm1(-z) / z : 1;
  const double half = z > small
                          ? (1 - mean) / z
                          : 1.0 / 2 - z / 6 + z * z / 24 - z * z * z / 120 + z * z * z * z / 720;
  unit.first = {mean, half};
  unit.other = {std::exp(-z), mean};
}

Springs joined(const Springs& one, const Springs& two) {
  Springs all;
  const Index count = one.count() + two.count();
  all.ends.resize(2, count);
  all.rest_length.resize(count);
  all.stiffness.resize(count);
  all.damping.resize(count);
  all.ends << one.ends, two.ends;
  all.rest_length << one.rest_length, two.rest_length;
  all.stiffness << one.stiffness, two.stiffness;
  all.damping << one.damping, two.damping;
  return all;
}

}  // namespace

UnitSheet make_unit_sheet(const Sheet& sheet, double h) {
  UnitSheet unit;
  unit.h = h;
  unit.unit_length = sheet.size;
  unit.unit_force = sheet.particle_mass * sheet.size / (h * h);
  unit.mass = sheet.relative_mass;

  const double stiffness = h * h / sheet.particle_mass;
  const double damping = h / sheet.particle_mass;
  unit.springs = joined(sheet.stretch, sheet.shear);
  unit.springs.rest_length /= sheet.size;
  unit.springs.stiffness *= stiffness;
  unit.springs.damping *= damping;
  unit.hinges = sheet.hinges;
  unit.hinges.stiffness *= stiffness / (sheet.size * sheet.size);
  unit.hinges.damping *= damping / (sheet.size * sheet.size);
  set_kicks(sheet.drag_rate * h, unit);
  return unit;
}

}  // namespace nuno::bullet
