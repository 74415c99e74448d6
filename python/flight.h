#pragma once

#include <nuno/rollout.h>

#include <memory>
#include <string>
#include <vector>

#include "scene.h"

namespace nuno::python {

/// One flight as Python holds it. Never changes.
struct Flight {
  ScenePointer scene;
  std::string backend;
  Index steps = 0;
  Rollout rollout = {};             ///< without positions of its frames
  std::vector<double> frames = {};  ///< [frames × particles × dimension], m
  double sensitivity = 0;
  std::vector<Points> reference_correction = {};  ///< that it was flown with, see Problem
  std::string optimization = {};  ///< of a result file, as JSON; empty where no gain was searched
};

/// Flies at these gains, keeps the scene's frames and those of a `tail` [s], and judges the flight.
/// `file` is the scene's, with the caller's stop. Throws Diverged.
Flight fly(const ScenePointer& scene, const SceneFile& file, const Backend& asked,
           const Gains& gains, double tail);

/// A flight that diverged, at which step and why.
class Diverged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Adds the class Result.
void add_flights(pybind11::module_& module);

}  // namespace nuno::python
