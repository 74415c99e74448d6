#include "flight.h"

#include <pybind11/stl.h>

#include <nuno/animation.h>
#include <nuno/conditioning.h>
#include <nuno/output.h>
#include <nuno/result_file.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "arrays.h"
#include "interrupt.h"
#include "options.h"

namespace nuno::python {
namespace {

using namespace pybind11::literals;

/// The engine of a flight that has been flown, as far as a result tells of it.
class FlownOn : public Backend {
 public:
  explicit FlownOn(const Flight& flight)
      : Backend(named(flight.backend), flown_problem(flight), flight.steps) {}

 private:
  static std::string_view named(const std::string& name) {
    return *std::ranges::find(backend_names, name);
  }
  static Problem flown_problem(const Flight& flight) {
    Problem problem = flight.scene->file.problem;
    problem.reference_correction = flight.reference_correction;
    return problem;
  }
  std::unique_ptr<Simulation> do_start(const Points&, const Points&) const override {
    std::abort();
  }
  DragRecurrence do_drag_recurrence() const override { std::abort(); }
};

std::vector<Points> frames_apart(const Flight& flight) {
  const Cloth& cloth = flight.scene->cloth();
  const Index numbers = cloth.initial.size();
  std::vector<Points> frames;
  for (std::size_t k = 0; k < flight.rollout.frame_times.size(); ++k) {
    frames.emplace_back(
        Eigen::Map<const Points>(flight.frames.data() + static_cast<Index>(k) * numbers,
                                 cloth.dimension(), cloth.particles()));
  }
  return frames;
}

/// Frames in one piece, as numpy has them.
std::vector<double> frames_together(std::vector<Points> frames) {
  std::vector<double> numbers;
  if (!frames.empty()) {
    numbers.reserve(frames.size() * static_cast<std::size_t>(frames.front().size()));
  }
  for (Points& frame : frames) {
    numbers.insert(numbers.end(), frame.data(), frame.data() + frame.size());
    frame.resize(0, 0);  // so that the flight is not in memory twice
  }
  return numbers;
}

void write_json(std::FILE* file, const Flight& flight) {
  Rollout rollout = flight.rollout;
  rollout.frame_positions = frames_apart(flight);
  write_result(file, flight.scene->file.input, FlownOn(flight), rollout, flight.sensitivity,
               flight.optimization);
}

std::string to_json(const Flight& flight) {
  return written_text([&](std::FILE* file) { write_json(file, flight); });
}

void save(const Flight& flight, const std::string& path, const AnimationOptions& animation) {
  without_lock(
      [&] {
        require_room(flight.scene->file, path, animation);
        if (!is_animation(path)) {
          write_output(path, [&](std::FILE* file) { write_json(file, flight); });
          return;
        }
        Rollout rollout;
        rollout.frame_times = flight.rollout.frame_times;
        rollout.frame_positions = frames_apart(flight);
        write_flight(path, flight.scene->file, FlownOn(flight), rollout, flight.sensitivity,
                     animation, std::nullopt);
      },
      std::stop_source());
}

template <typename Read>
auto array_property(Read read) {
  return [read](const py::object& self) { return view(read(self.cast<const Flight&>()), self); };
}

py::array frames_view(const py::object& self) {
  const auto& flight = self.cast<const Flight&>();
  const Cloth& cloth = flight.scene->cloth();
  const auto count = static_cast<py::ssize_t>(flight.rollout.frame_times.size());
  return view(flight.frames.data(), {count, cloth.particles(), cloth.dimension()}, self);
}

py::tuple state_of(const Flight& flight) {
  const Rollout& rollout = flight.rollout;
  const auto copy = [](const Points& points) {
    return py::array_t<double>({points.cols(), points.rows()}, points.data());
  };
  const auto numbers = [](const std::vector<double>& from) {
    return py::array_t<double>(static_cast<py::ssize_t>(from.size()), from.data());
  };
  py::list correction;
  for (const Points& shape : flight.reference_correction) correction.append(copy(shape));
  return py::make_tuple(
      flight.scene, flight.backend, flight.steps, rollout.gains.groups(),
      copy(rollout.launch_velocity), copy(rollout.final), copy(rollout.final_velocity),
      py::make_tuple(rollout.error.mean, rollout.error.max, rollout.error.centroid),
      rollout.control_effort, rollout.max_strain, numbers(rollout.frame_times),
      numbers(flight.frames), flight.sensitivity, flight.optimization, rollout.step_error,
      correction, rollout.finer_strain, rollout.truncation_error);
}

Flight flight_of_state(const py::tuple& state) {
  const auto points = [&](int i) {
    return points_of(state[static_cast<std::size_t>(i)].cast<Array>(), 0, 0, "a pickled result");
  };
  const auto numbers = [&](std::size_t i) {
    const auto array = state[i].cast<Array>();
    return std::vector<double>(array.data(), array.data() + array.size());
  };
  Flight flight{state[0].cast<ScenePointer>(), state[1].cast<std::string>(),
                state[2].cast<Index>()};
  Rollout& rollout = flight.rollout;
  rollout.gains = Gains::of_groups(state[3].cast<std::vector<double>>());
  rollout.launch_velocity = points(4);
  rollout.final = points(5);
  rollout.final_velocity = points(6);
  const auto error = state[7].cast<py::tuple>();
  rollout.error = {error[0].cast<double>(), error[1].cast<double>(), error[2].cast<double>()};
  rollout.control_effort = state[8].cast<double>();
  rollout.max_strain = state[9].cast<double>();
  rollout.frame_times = numbers(10);
  flight.frames = numbers(11);
  flight.sensitivity = state[12].cast<double>();
  flight.optimization = state[13].cast<std::string>();
  rollout.step_error = state[14].cast<std::optional<double>>();
  rollout.finer_strain = state[16].cast<std::optional<double>>();
  rollout.truncation_error = state[17].cast<double>();
  for (const py::handle shape : state[15].cast<py::list>()) {
    flight.reference_correction.push_back(points_of(shape.cast<Array>(), 0, 0, "a pickled result"));
  }
  return flight;
}

using Class = py::class_<Flight, std::shared_ptr<Flight>>;

void add_numbers(Class& result) {
  result.def_property_readonly(
      "scene", [](const Flight& self) { return self.scene; }, "The Scene that was flown.");
  result.def_readonly("backend", &Flight::backend, "The engine's name.");
  result.def_property_readonly(
      "alpha", [](const Flight& self) { return self.rollout.gains.rest; },
      "The gain [N/m]; with several gains that of the last group.");
  result.def_property_readonly(
      "alphas",
      [](const Flight& self) {
        std::vector<double> groups = self.rollout.gains.groups();
        const auto count = static_cast<py::ssize_t>(groups.size());
        return owned(std::move(groups), {count});
      },
      "The gain of every group [N/m], from the longest waves to the rest: (groups,).");
  result.def_readonly("steps", &Flight::steps, "Number of time steps until arrival.");
  result.def_property_readonly(
      "time_step",
      [](const Flight& self) {
        return self.scene->file.scene.arrival_time / static_cast<double>(self.steps);
      },
      "The engine's time step [s].");
  result.def_property_readonly(
      "error", [](const Flight& self) { return self.rollout.error.mean; },
      "Mean distance of the particles from the target at arrival [m].");
  result.def_property_readonly(
      "relative_error",
      [](const Flight& self) { return self.rollout.error.mean / self.scene->cloth().size; },
      "`error` over the cloth's size L [1].");
  result.def_property_readonly(
      "max_error", [](const Flight& self) { return self.rollout.error.max; },
      "Distance of the worst particle [m].");
  result.def_property_readonly(
      "centroid_error", [](const Flight& self) { return self.rollout.error.centroid; },
      "Distance of the mass centres [m].");
  result.def_property_readonly(
      "control_effort", [](const Flight& self) { return self.rollout.control_effort; },
      "Root mean square of the control force, in weights of a particle (without gravity in units "
      "of its mass times L/t0^2).");
  result.def_property_readonly(
      "max_strain", [](const Flight& self) { return self.rollout.max_strain; },
      "Largest |l/rest length - 1| of an edge on the way [1].");
  result.def_readonly("sensitivity", &Flight::sensitivity,
                      "How much a small change at the start has grown by arrival [1].");
  result.def_property_readonly(
      "truncation_error", [](const Flight& self) { return self.rollout.truncation_error; },
      "Sum of the time steps' local truncation errors, root mean square over the particles, over L "
      "[1].");
  result.def_property_readonly(
      "step_error", [](const Flight& self) { return self.rollout.step_error; },
      "How far half of the time step moves the end shape, over L [1]; None where that is not in "
      "doubt, or would take too long.");
  result.def_property_readonly(
      "finer_strain", [](const Flight& self) { return self.rollout.finer_strain; },
      "`max_strain` with half of the time step [1], measured beside `step_error`.");
  result.def_property_readonly(
      "fragility", [](const Flight& self) { return fragility(self.sensitivity); },
      "The word of warning for a fragile flight; empty for a calm one.");
  result.def_property_readonly(
      "reference_correction",
      [](const py::object& self) -> py::object {
        const auto& shapes = self.cast<const Flight&>().reference_correction;
        if (shapes.empty()) return py::none();
        py::list views;
        for (const Points& shape : shapes) views.append(view(shape, self));
        return views;
      },
      "What moved the reference of a refined flight [m]: four times (particles, dimension), for "
      "`simulate`; None of one that was not refined.");
  result.def_readonly("optimization_json", &Flight::optimization,
                      "How the gain was searched, as JSON; empty where none was.");
}

void add_arrays(Class& result) {
  result.def_property_readonly("launch_velocity",
                               array_property([](const Flight& self) -> const Points& {
                                 return self.rollout.launch_velocity;
                               }),
                               "Of every particle [m/s]: (particles, dimension).");
  result.def_property_readonly("final", array_property([](const Flight& self) -> const Points& {
                                 return self.rollout.final;
                               }),
                               "Positions at arrival [m]: (particles, dimension).");
  result.def_property_readonly(
      "final_velocity", array_property([](const Flight& self) -> const Points& {
        return self.rollout.final_velocity;
      }),
      "At arrival, the mean over the last step [m/s]: (particles, dimension).");
  result.def_property_readonly(
      "times",
      [](const py::object& self) {
        const auto& times = self.cast<const Flight&>().rollout.frame_times;
        return view(times.data(), {static_cast<py::ssize_t>(times.size())}, self);
      },
      "Of the frames [s]: (frames,).");
  result.def_property_readonly("frames", frames_view,
                               "Positions on the way [m]: (frames, particles, dimension).");
}

}  // namespace

Flight fly(const ScenePointer& scene, const SceneFile& file, const Backend& asked,
           const Gains& gains, double tail) {
  JudgedRollout flown = judged_rollout(
      asked, file, gains, {.frames_per_second = file.scene.frames_per_second, .tail = tail});
  if (diverged(flown.flight)) throw Diverged(divergence_message(file.path, asked, flown.flight));
  const Backend& backend = flown.finer ? *flown.finer : asked;
  Flight flight{scene, std::string(backend.name()), backend.steps()};
  flight.sensitivity = flown.sensitivity;
  flight.reference_correction = backend.problem().reference_correction;
  flight.rollout = std::move(flown.flight);
  flight.frames = frames_together(std::move(flight.rollout.frame_positions));
  flight.rollout.frame_positions.clear();
  return flight;
}

void add_flights(py::module_& module) {
  Class result(module, "Result", R"(One flight, and how it arrived. Never changes; can be pickled.

All arrays are read-only views of it: particles in rows, x, y (and z) in columns.)");
  add_numbers(result);
  add_arrays(result);
  result.def("to_json", to_json, "The result file's text, as `nuno` writes it.");
  result.def(
      "save",
      [](const Flight& self, const py::object& path, Index first_frame, Index hold_frames,
         std::optional<double> ribbon_width) {
        AnimationOptions animation;
        animation.first_frame = whole_number("--first-frame", first_frame, 0, 1000000);
        animation.held_frames = whole_number("--hold-frames", hold_frames, 0, 1000000);
        if (ribbon_width) animation.ribbon_width = positive("--ribbon-width", *ribbon_width);
        save(self, py::module_::import("os").attr("fspath")(path).cast<std::string>(), animation);
      },
      "path"_a, py::kw_only(), "first_frame"_a = AnimationOptions().first_frame,
      "hold_frames"_a = AnimationOptions().held_frames, "ribbon_width"_a = py::none(),
      R"(Writes it, whole or not at all: a result file (.json), or an animated mesh by the name's end
(.glb, .usda, .pc2, .mdd, numbered ####.obj).)");
  result.def("__repr__", [](const Flight& self) {
    return py::str("<nuno.Result {!r} on {}: alpha {:.4g} N/m, error {:.4g} % of L>")
        .format(self.scene->file.scene.name, self.backend, self.rollout.gains.rest,
                100 * self.rollout.error.mean / self.scene->cloth().size);
  });
  result.def(py::pickle([](const Flight& self) { return state_of(self); },
                        [](const py::tuple& state) { return flight_of_state(state); }));
}

}  // namespace nuno::python
