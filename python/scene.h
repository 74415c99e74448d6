#pragma once

#include <pybind11/pybind11.h>

#include <nuno/engines.h>
#include <nuno/scene_file.h>

#include <memory>
#include <string>

namespace nuno::python {

/// A scene as Python holds it: as it was given, and made ready to be flown. Python cannot change
/// it.
struct HeldScene {
  AnyScene given;
  SceneFile file;

  HeldScene(const std::string& source, AnyScene scene)
      : given(std::move(scene)), file(make_scene_file(source, given)) {}

  const Cloth& cloth() const { return file.problem.cloth(); }
};
using ScenePointer = std::shared_ptr<HeldScene>;

/// The scene's file with a stop that the caller may request, see Problem::stop.
SceneFile stoppable(const HeldScene& scene, const std::stop_source& stop);

/// Adds the class Scene, and what makes scenes.
void add_scenes(pybind11::module_& module);

}  // namespace nuno::python
