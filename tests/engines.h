#pragma once

#include <nuno/box2d.h>
#include <nuno/bullet.h>
#include <nuno/native.h>

#include <ostream>

namespace nuno {

/// An engine as the shared suites see it, with what its arithmetic can hold.
struct Engine {
  const char* name;
  std::unique_ptr<Backend> (*make)(const Problem& problem, std::optional<double> time_step);
  /// Rounding of a coordinate that moves over metres: 2⁻⁵³ or 2⁻²⁴, times what a thousand steps
  /// add.
  double rounding;
  /// Solves its joints by sweeping over them, to a tolerance.
  bool sweeps_joints;
};

inline std::unique_ptr<Backend> make_native(const Problem& problem,
                                            std::optional<double> time_step) {
  return native::make_backend(with_time_step(problem, time_step));
}

inline std::unique_ptr<Backend> make_bullet(const Problem& problem,
                                            std::optional<double> time_step) {
  return bullet::make_backend(with_time_step(problem, time_step));
}

template <box2d::Hinge hinge>
std::unique_ptr<Backend> make_box2d(const Problem& problem, std::optional<double> time_step) {
  return box2d::make_backend_with({.hinge = hinge}, with_time_step(problem, time_step));
}

inline const Engine native_engine = {"native", make_native, 1e-11, false};
inline const Engine box2d_weld_engine = {"box2d_soft_weld", make_box2d<box2d::Hinge::soft_weld>,
                                         3e-4, true};
inline const Engine box2d_pair_engine = {"box2d_spring_pair", make_box2d<box2d::Hinge::spring_pair>,
                                         3e-4, true};
// Single precision of coordinates of the sheet's size only.
inline const Engine bullet_engine = {"bullet", make_bullet, 1e-5, false};

inline std::ostream& operator<<(std::ostream& out, const Engine& engine) {
  return out << engine.name;
}

}  // namespace nuno
