#pragma once

#include <nuno/problem.h>

namespace nuno {

/// Units in place of metre, second and newton; that of mass follows, force·time²/length.
struct Units {
  double length = 1;  ///< [m]
  double time = 1;    ///< [s]
  double force = 1;   ///< [N]

  double mass() const { return force * time * time / length; }  ///< [kg]
  double gain() const { return force / length; }                ///< [N/m]
};

inline void scale_material(ChainMaterial& cloth, const Units& unit) {
  cloth.mass *= unit.mass();
  cloth.air_drag *= unit.mass() / unit.time;
  cloth.stretch_stiffness *= unit.force;
  cloth.stretch_damping *= unit.force * unit.time;
  cloth.hinge_stiffness *= unit.force * unit.length * unit.length;
  cloth.hinge_damping *= unit.force * unit.length * unit.length * unit.time;
}

inline void scale_material(SheetMaterial& cloth, const Units& unit) {
  const double area = unit.length * unit.length;
  cloth.areal_density *= unit.mass() / area;
  cloth.air_drag *= unit.mass() / unit.time / area;
  cloth.stretch_stiffness *= unit.force / unit.length;
  cloth.stretch_damping *= unit.force / unit.length * unit.time;
  cloth.shear_stiffness *= unit.force / unit.length;
  cloth.shear_damping *= unit.force / unit.length * unit.time;
  cloth.bending_stiffness *= unit.force * unit.length;
  cloth.bending_damping *= unit.force * unit.length * unit.time;
}

/// A scene whose numbers, given in metres, seconds and newtons, are meant in other units.
template <class AnyScene>
AnyScene in_units(AnyScene scene, const Units& unit) {
  scene.initial *= unit.length;
  scene.target *= unit.length;
  scene.arrival_time *= unit.time;
  scene.gravity *= unit.length / (unit.time * unit.time);
  scene.frames_per_second /= unit.time;
  if (scene.time_step) *scene.time_step *= unit.time;
  scale_material(scene.cloth, unit);
  return scene;
}

}  // namespace nuno
