#include "backend.h"

#include <pybind11/stl.h>

#include <nuno/launch.h>
#include <nuno/optimize.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

#include "arrays.h"
#include "interrupt.h"
#include "options.h"
#include "scene.h"

namespace nuno::python {
namespace {

using namespace pybind11::literals;

/// An engine, and how to end whatever it does.
struct Engine {
  std::stop_source stop;
  std::unique_ptr<Backend> backend;
};
using EnginePointer = std::shared_ptr<const Engine>;

/// An engine that many calls share. A call that is interrupted ends all that run on it: they go on,
/// and later ones begin, on a new one.
class HeldBackend {
 public:
  HeldBackend(ScenePointer scene, std::string name, double gain)
      : scene_(std::move(scene)), name_(std::move(name)), gain_(gain) {
    const std::stop_source stop;
    without_lock([&] { engine_ = make(stop); }, stop);
  }

  const ScenePointer& scene() const { return scene_; }

  EnginePointer engine() const {
    const std::lock_guard lock(mutex_);
    return engine_;
  }

  /// Has `work` work on the engine, again from the start where another call was interrupted.
  template <typename Work>
  void use(Work work) {
    for (;;) {
      const EnginePointer engine = this->engine();
      try {
        return without_lock([&] { work(*engine->backend); }, engine->stop);
      } catch (const Stopped&) {
        renew(engine);
      } catch (const py::error_already_set&) {
        renew(engine);
        throw;
      }
    }
  }

 private:
  EnginePointer make(const std::stop_source& stop) const {
    return std::make_shared<Engine>(
        Engine{stop, make_backend_for_gain(name_, stoppable(*scene_, stop), gain_)});
  }

  void renew(const EnginePointer& stopped) {
    const std::lock_guard lock(mutex_);
    if (engine_ == stopped) engine_ = make(std::stop_source());
  }

  ScenePointer scene_;
  std::string name_;
  double gain_;
  mutable std::mutex mutex_;
  EnginePointer engine_;
};

/// A cloth in flight, and the engine that it flies on.
struct HeldSimulation {
  EnginePointer engine;
  std::unique_ptr<Simulation> cloth;
  Index steps = 0;
};

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

py::array_t<double> errors_of(HeldBackend& self, const Array& alphas) {
  const std::vector<Gains> gains = gains_of(alphas, *self.engine()->backend, "alphas");
  std::vector<double> errors;
  self.use([&](const Backend& backend) { errors = backend.errors(gains); });
  const auto count = static_cast<py::ssize_t>(errors.size());
  return owned(std::move(errors), {count});
}

std::vector<ErrorSample> samples_of(HeldBackend& self, const Array& alphas) {
  const Backend& engine = *self.engine()->backend;
  if (!engine.has_derivatives()) {
    throw InputError(fmt::format("{}: knows no derivatives; native does", engine.name()));
  }
  const std::vector<Gains> gains = gains_of(alphas, engine, "alphas");
  std::vector<ErrorSample> samples;
  self.use([&](const Backend& backend) { samples = backend.error_samples(gains); });
  return samples;
}

py::tuple gradients_of(HeldBackend& self, const Array& alphas) {
  std::vector<double> errors, gradients;
  for (const ErrorSample& sample : samples_of(self, alphas)) {
    errors.push_back(sample.error);
    for (const ErrorSample::Derivative& by : sample.derivatives) gradients.push_back(by.error);
  }
  const auto count = static_cast<py::ssize_t>(errors.size());
  const std::vector<py::ssize_t> shape(alphas.shape(), alphas.shape() + alphas.ndim());
  return py::make_tuple(owned(std::move(errors), {count}), owned(std::move(gradients), shape));
}

py::tuple residuals_of(HeldBackend& self, const Array& alphas) {
  const Cloth& cloth = self.scene()->cloth();
  const auto append = [&](std::vector<double>& to, const Points& points) {
    if (points.size() == 0) {  // it diverged
      to.insert(to.end(), static_cast<std::size_t>(cloth.initial.size()), nothing);
    } else {
      to.insert(to.end(), points.data(), points.data() + points.size());
    }
  };
  std::vector<double> residuals, derivatives;
  for (const ErrorSample& sample : samples_of(self, alphas)) {
    append(residuals, sample.residual);
    for (const ErrorSample::Derivative& by : sample.derivatives) append(derivatives, by.residual);
  }
  std::vector<py::ssize_t> shape = {alphas.shape(0), cloth.particles(), cloth.dimension()};
  std::vector<py::ssize_t> by_gain = shape;
  if (alphas.ndim() == 2) by_gain.insert(by_gain.begin() + 1, alphas.shape(1));
  return py::make_tuple(owned(std::move(residuals), shape), owned(std::move(derivatives), by_gain));
}

py::array copied(const Points& points) {
  return py::array_t<double>({points.cols(), points.rows()}, points.data());
}

HeldSimulation start(HeldBackend& self, const std::optional<Array>& velocities,
                     const std::optional<Array>& positions) {
  const EnginePointer engine = self.engine();
  const Backend& backend = *engine->backend;
  const Cloth& cloth = backend.cloth();
  const auto given = [&](const Array& array, const char* at) {
    Points points = points_of(array, cloth.dimension(), cloth.particles(), at);
    if (!points.allFinite()) throw InputError(fmt::format("{}: not all are finite", at));
    return points;
  };
  const Points at = positions ? given(*positions, "positions") : cloth.initial;
  const Points with = velocities ? given(*velocities, "velocities") : launch(backend);
  return {engine, backend.start(at, with)};
}

void step(HeldSimulation& self, const std::optional<Array>& forces) {
  const Cloth& cloth = self.engine->backend->cloth();
  Points given = Points::Zero(cloth.dimension(), cloth.particles());
  if (forces) given = points_of(*forces, cloth.dimension(), cloth.particles(), "forces");
  if (!given.allFinite()) throw InputError("forces: not all are finite");
  self.cloth->step(given);
  ++self.steps;
}

void add_simulation(py::module_& module) {
  py::class_<HeldSimulation> simulation(
      module, "Simulation",
      R"(One cloth in flight, to be controlled step by step by forces of one's own.

Made by Backend.start.)");
  simulation.def("step", step, "forces"_a = py::none(),
                 R"(Advances by one time step under external forces [N], (particles, dimension).)");
  simulation.def_property_readonly(
      "positions", [](const HeldSimulation& self) { return copied(self.cloth->positions()); },
      "Now [m]: (particles, dimension), a copy.");
  simulation.def_property_readonly(
      "velocities", [](const HeldSimulation& self) { return copied(self.cloth->velocities()); },
      "Mean over the last step [m/s]: (particles, dimension), a copy.");
  simulation.def_property_readonly(
      "time",
      [](const HeldSimulation& self) {
        return static_cast<double>(self.steps) * self.engine->backend->time_step();
      },
      "Since launch [s].");
  simulation.def_property_readonly(
      "failure", [](const HeldSimulation& self) { return std::string(self.cloth->failure()); },
      "Why the engine gave the flight up; empty while it flies.");
}

void add_numbers(py::class_<HeldBackend>& backend) {
  const auto number = [&](const char* name, auto of, const char* doc) {
    backend.def_property_readonly(
        name, [of](const HeldBackend& self) { return of(*self.engine()->backend); }, doc);
  };
  number(
      "name", [](const Backend& of) { return std::string(of.name()); }, "The engine's name.");
  number(
      "time_step", [](const Backend& of) { return of.time_step(); }, "Time step [s].");
  number(
      "steps", [](const Backend& of) { return of.steps(); }, "Number of time steps until arrival.");
  number(
      "largest_gain", [](const Backend& of) { return of.largest_gain(); },
      "The largest gain that the time step resolves [N/m].");
  number(
      "gain_scale", [](const Backend& of) { return objective(of).gain_scale; },
      "m/t0^2 [N/m]: the gain whose oscillation turns by one radian until arrival.");
  number(
      "has_derivatives", [](const Backend& of) { return of.has_derivatives(); },
      "Whether `gradients` and `residuals` are there.");
  backend.def_property_readonly(
      "scene", [](const HeldBackend& self) { return self.scene(); }, "The Scene that it flies.");
}

}  // namespace

void add_backends(py::module_& module) {
  add_simulation(module);
  py::class_<HeldBackend> backend(
      module, "Backend",
      R"(An engine made ready for one scene, to be asked for E(alpha) many times.

`alpha` [N/m]: a gain that its time step shall resolve. May be shared by threads.)");
  backend.def(py::init([](ScenePointer scene, std::string name, double alpha) {
                require_backend(name);
                return std::make_unique<HeldBackend>(std::move(scene), std::move(name),
                                                     non_negative("--alpha", alpha));
              }),
              "scene"_a, "name"_a = "native", py::kw_only(), "alpha"_a = 0.0);
  add_numbers(backend);
  backend.def("errors", errors_of, "alphas"_a, R"(The error at arrival under many gains.

alphas [N/m]: (gains,), or (gains, groups) for gains by group of modes.
Returns E [m]: (gains,); infinite where a flight diverged.)");
  backend.def("gradients", gradients_of, "alphas"_a,
              R"(The error at arrival under many gains, and its exact derivatives.

alphas [N/m]: (gains,), or (gains, groups) for gains by group of modes.
Returns E [m]: (gains,), and dE/dalpha [m^2/N], in the shape of alphas; 0 where a flight diverged.)");
  backend.def("residuals", residuals_of, "alphas"_a,
              R"(Where the particles arrive under many gains, and the exact derivatives.

alphas [N/m]: (gains,), or (gains, groups) for gains by group of modes.
Returns final positions less the target [m]: (gains, particles, dimension), and their derivatives
[m^2/N]: (gains, particles, dimension) or (gains, groups, particles, dimension); NaN where a flight
diverged.)");
  backend.def(
      "launch",
      [](HeldBackend& self) {
        Points velocities;
        self.use([&](const Backend& engine) { velocities = launch(engine); });
        return copied(velocities);
      },
      "The launch velocities that the scene asks for [m/s]: (particles, dimension).");
  backend.def("start", start, "velocities"_a = py::none(), "positions"_a = py::none(),
              R"(A cloth in flight, a Simulation.

velocities [m/s] and positions [m]: (particles, dimension); by default the launch and the initial
shape.)");
}

}  // namespace nuno::python
