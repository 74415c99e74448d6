#include "scene.h"

#include <pybind11/stl.h>

#include <nuno/feasibility.h>
#include <nuno/input.h>
#include <nuno/materials.h>
#include <nuno/throw_scene.h>

#include <utility>

#include "arrays.h"
#include "interrupt.h"
#include "options.h"

namespace nuno::python {
namespace {

using namespace pybind11::literals;

ScenePointer hold(const std::string& source, AnyScene scene) {
  return std::make_shared<HeldScene>(source, std::move(scene));
}

Shapes shapes_given(const Array& initial, const Array& target, Faces faces,
                    const std::string& source) {
  const Index dimension = faces.empty() ? 2 : 3;
  return {points_of(initial, dimension, 0, source + ": /initial"),
          points_of(target, dimension, 0, source + ": /target"), std::move(faces)};
}

Shapes shapes_of_scene(const HeldScene& scene) {
  if (const auto* chain = std::get_if<ChainScene>(&scene.given)) {
    return {chain->initial, chain->target};
  }
  const SheetScene& sheet = std::get<SheetInput>(scene.given).scene;
  return {sheet.initial, sheet.target, sheet.faces};
}

ScenePointer throw_files(const ThrowRequest& request, const std::string& start,
                         const std::string& target) {
  return hold(throw_source(start, target), throw_scene(request, start, target));
}

py::tuple state_of(const HeldScene& scene) {
  const Shapes shapes = shapes_of_scene(scene);
  const py::none nobody;  // arrays that own their numbers
  const auto copy = [](const Points& points) {
    return py::array_t<double>({points.cols(), points.rows()}, points.data());
  };
  py::tuple texture(0);
  if (const Mesh* const mesh = scene.file.mesh(); mesh && mesh->texture_coordinates.cols() > 0) {
    texture = py::make_tuple(copy(mesh->texture_coordinates), mesh->texture_corners);
  }
  py::tuple welded(0);
  if (const Mesh* const mesh = scene.file.mesh()) {
    welded = py::make_tuple(mesh->file_vertices, mesh->remarks);
  }
  return py::make_tuple(scene.file.path, fields_to_json(scene.given), copy(shapes.initial),
                        copy(shapes.target), shapes.faces, texture, welded);
}

ScenePointer scene_of_state(const py::tuple& state) {
  const auto source = state[0].cast<std::string>();
  const Shapes shapes =
      shapes_given(state[2].cast<Array>(), state[3].cast<Array>(), state[4].cast<Faces>(), source);
  AnyScene scene = parse_scene_of(shapes, state[1].cast<std::string>(), source);
  if (auto* sheet = std::get_if<SheetInput>(&scene)) {
    const auto texture = state[5].cast<py::tuple>(), welded = state[6].cast<py::tuple>();
    if (!texture.empty()) {
      sheet->mesh.texture_coordinates = points_of(texture[0].cast<Array>(), 2, 0, source);
      sheet->mesh.texture_corners = texture[1].cast<Faces>();
    }
    sheet->mesh.file_vertices = welded[0].cast<std::vector<Index>>();
    sheet->mesh.remarks = welded[1].cast<std::vector<std::string>>();
  }
  return hold(source, std::move(scene));
}

std::string verdict_of(const HeldScene& scene, const std::string& backend) {
  require_backend(backend);
  std::string words;
  const std::stop_source stop;
  without_lock([&] { words = verdict(assess(*make_backend(backend, stoppable(scene, stop)))); },
               stop);
  return words;
}

void add_class(py::module_& module) {
  py::class_<HeldScene, ScenePointer> scene(
      module, "Scene", R"(A cloth, a target, and what is asked of the throw. Never changes.

Made by read_scene, make_scene and throw_scene; can be pickled. Lengths are in metres, times in
seconds, y is up. All arrays are read-only views.)");
  scene.def_property_readonly(
      "name", [](const HeldScene& self) { return self.file.scene.name; }, "Its name.");
  scene.def_property_readonly(
      "source", [](const HeldScene& self) { return self.file.path; },
      "What messages call it: its file.");
  scene.def_property_readonly(
      "arrival_time", [](const HeldScene& self) { return self.file.scene.arrival_time; },
      "t0 [s]: when the cloth arrives.");
  scene.def_property_readonly(
      "frames_per_second", [](const HeldScene& self) { return self.file.scene.frames_per_second; },
      "Frames kept of a flight [1/s].");
  scene.def_property_readonly(
      "particles", [](const HeldScene& self) { return self.cloth().particles(); },
      "Number of particles N.");
  scene.def_property_readonly(
      "dimension", [](const HeldScene& self) { return self.cloth().dimension(); },
      "2 of a chain in the plane, 3 of a sheet in space.");
  scene.def_property_readonly(
      "size", [](const HeldScene& self) { return self.cloth().size; },
      "L [m], what errors are relative to: a chain's length, sqrt(rest area) of a sheet.");
  scene.def_property_readonly(
      "particle_mass", [](const HeldScene& self) { return self.cloth().particle_mass; },
      "Mean mass of a particle [kg].");
  scene.def_property_readonly(
      "target_scale", [](const HeldScene& self) { return self.file.problem.target_scale; },
      "By how much `fit` scaled the target [1].");
  scene.def_property_readonly(
      "initial",
      [](const py::object& self) { return view(self.cast<HeldScene&>().cloth().initial, self); },
      "Positions at t = 0 [m]: (particles, dimension).");
  scene.def_property_readonly(
      "target",
      [](const py::object& self) {
        return view(self.cast<HeldScene&>().file.problem.target, self);
      },
      "Where the particles should be at arrival [m]: (particles, dimension).");
  scene.def_property_readonly(
      "faces", [](const HeldScene& self) { return shapes_of_scene(self).faces; },
      "Of a sheet, the vertices around each face, from 0 on; empty of a chain.");
  scene.def_property_readonly(
      "fields_json", [](const HeldScene& self) { return fields_to_json(self.given); },
      "Its fields but for the shapes, as the JSON text of a scene file.");
  scene.def("__repr__", [](const HeldScene& self) {
    return py::str("<nuno.Scene {!r}: {} particles in {} dimensions, {} s>")
        .format(self.file.scene.name, self.cloth().particles(), self.cloth().dimension(),
                self.file.scene.arrival_time);
  });
  scene.def(py::pickle([](const HeldScene& self) { return state_of(self); },
                       [](const py::tuple& state) { return scene_of_state(state); }));
}

}  // namespace

SceneFile stoppable(const HeldScene& scene, const std::stop_source& stop) {
  SceneFile file = scene.file;
  file.problem.stop = stop.get_token();
  return file;
}

void add_scenes(py::module_& module) {
  add_class(module);
  module.def(
      "scene_of_text",
      [](const std::string& text, const std::string& path) {
        return hold(name_of_input(path), parse_any_scene(text, path));
      },
      "text"_a, "path"_a, "A scene from the JSON text that is in the file at `path`.");
  module.def(
      "scene_of_file",
      [](const std::string& path) { return hold(name_of_input(path), read_scene(path)); }, "path"_a,
      "A scene from its file.");
  module.def(
      "scene_of_points",
      [](const std::string& text, const std::string& source, const Array& initial,
         const Array& target, Faces faces) {
        return hold(source, parse_scene_of(shapes_given(initial, target, std::move(faces), source),
                                           text, source));
      },
      "text"_a, "source"_a, "initial"_a, "target"_a, "faces"_a,
      "A scene from the JSON text of its fields, and its shapes.");
  py::class_<ThrowRequest>(module, "ThrowRequest", "What is asked of a throw.")
      .def(py::init([](double time, const std::optional<std::string>& material,
                       std::optional<double> frames_per_second, bool settle) {
             ThrowRequest request;
             request.arrival_time = positive("--time", time);
             request.material = material.value_or("");
             if (frames_per_second) {
               request.frames_per_second = positive("--frames-per-second", *frames_per_second);
             }
             request.settle = settle;
             return request;
           }),
           "time"_a, "material"_a, "frames_per_second"_a, "settle"_a);
  module.def("throw_files", throw_files, "request"_a, "start"_a, "target"_a,
             "The scene of a throw from files; an empty `target` is in `start`.");
  module.def(
      "throw_points",
      [](const ThrowRequest& request, const Array& initial, const Array& target, Faces faces) {
        const std::string source = "throw";
        AnyScene scene =
            throw_scene(request, shapes_given(initial, target, std::move(faces), source), source);
        return hold(source, std::move(scene));
      },
      "request"_a, "initial"_a, "target"_a, "faces"_a, "The scene of a throw from points.");
  module.def("verdict", verdict_of, "scene"_a, py::kw_only(), "backend"_a = "native",
             R"(What stands in the way of the cloth, in words; empty if nothing does.

Known before any flight: a target that is too long or too short, a launch that stretches, ...)");
  module.def(
      "materials",
      [] {
        std::vector<std::string> names;
        for (const NamedMaterial& each : named_materials()) names.emplace_back(each.name);
        return names;
      },
      "Names of the sheets' materials.");
}

}  // namespace nuno::python
