#include <pybind11/stl.h>

#include <nuno/comparison.h>
#include <nuno/conditioning.h>
#include <nuno/output.h>
#include <nuno/parallel.h>
#include <nuno/reference_motion.h>

#include <optional>
#include <utility>

#include "arrays.h"
#include "backend.h"
#include "flight.h"
#include "interrupt.h"
#include "options.h"

namespace nuno::python {
namespace {

using namespace pybind11::literals;

using FlightPointer = std::shared_ptr<Flight>;

/// One gain, or one for every group.
Gains gains_given(const std::vector<double>& alphas) {
  if (alphas.empty() || static_cast<Index>(alphas.size()) > most_groups) {
    throw InputError("--alpha: takes 1 … " + std::to_string(most_groups) + " gains");
  }
  for (const double alpha : alphas) non_negative("--alpha", alpha);
  return Gains::of_groups(alphas);
}

/// What every flight is asked before it is made.
void require_right_flight(const HeldScene& scene, const std::string& backend, double tail) {
  require_backend(backend);
  require_few_frames(scene.file, non_negative("--tail", tail));
}

FlightPointer simulate(const ScenePointer& scene, const std::vector<double>& alphas,
                       const std::string& backend, double tail,
                       const std::optional<Array>& correction) {
  require_right_flight(*scene, backend, tail);
  const Gains gains = gains_given(alphas);
  require_groups(scene->file, gains.count());
  const std::stop_source stop;
  SceneFile file = stoppable(*scene, stop);
  if (correction) {
    const Cloth& cloth = scene->cloth();
    file.problem.reference_correction =
        shapes_of(*correction, cloth.dimension(), cloth.particles(), "reference_correction");
    if (file.problem.reference_correction.size() != correction_powers.size()) {
      throw InputError("reference_correction: takes a shape for each of " +
                       std::to_string(correction_powers.size()) + " powers of time");
    }
  }
  FlightPointer flight;
  without_lock(
      [&] {
        const auto engine = make_backend_for_gain(backend, file, gains.largest());
        require_short_tail(*engine, tail);
        flight = std::make_shared<Flight>(fly(scene, file, *engine, gains, tail));
      },
      stop);
  return flight;
}

FlightPointer optimize(const ScenePointer& scene, const std::string& backend,
                       const SearchOptions& options, double tail) {
  require_right_flight(*scene, backend, tail);
  require_right(options);
  require_groups(scene->file, options.coefficients);
  if (options.refine) require_refinable(scene->file);
  const std::stop_source stop;
  const SceneFile file = stoppable(*scene, stop);
  FlightPointer flight;
  without_lock(
      [&] {
        auto engine = make_backend(backend, file);
        require_short_tail(*engine, tail);
        const SearchAnswer answer = search(file, std::move(engine), options);
        flight = std::make_shared<Flight>(fly(scene, file, *answer.backend, answer.gains, tail));
        flight->optimization = optimization_to_json(answer.how);
      },
      stop);
  return flight;
}

/// OnOneCore for as long as a `with` of Python's lasts.
struct HeldCore {
  std::optional<OnOneCore> alone;
};

/// What ends the work of every thread that is within its `with` of Python's.
struct SharedStop {
  std::stop_source source;
};

/// compare.json of one scene, as text.
std::string compare_json(const ScenePointer& scene) {
  const std::stop_source stop;
  const SceneFile file = stoppable(*scene, stop);
  std::string text;
  without_lock(
      [&] {
        const auto& [one, other] = engines_for(file.problem);
        const auto first = make_backend(one, file), second = make_backend(other, file);
        const Comparison comparison = compare_engines(file.scene.name, *first, *second);
        if (comparison.divergence) {
          const auto& [backend, flight] = *comparison.divergence;
          throw Diverged(
              divergence_message(file.path, backend == first->name() ? *first : *second, flight));
        }
        text = written_text([&](std::FILE* out) { write_comparisons(out, {comparison}); });
      },
      stop);
  return text;
}

}  // namespace

void add_searches(py::module_& module) {
  module.def("simulate", simulate, "scene"_a, "alphas"_a, "backend"_a, "tail"_a, "correction"_a,
             "One flight.");
  module.def(
      "optimize",
      [](const ScenePointer& scene, const std::string& backend,
         std::optional<std::string> optimizer, std::optional<double> error_limit,
         std::optional<double> effort_limit, Index coefficients, bool refine, bool robust,
         double tail) {
        const SearchOptions options{std::move(optimizer), error_limit, effort_limit,
                                    coefficients,         refine,      robust};
        return optimize(scene, backend, options, tail);
      },
      "scene"_a, "backend"_a, "optimizer"_a, "error_limit"_a, "effort_limit"_a, "coefficients"_a,
      "refine"_a, "robust"_a, "tail"_a, "The flight at the best gain.");
  module.def("compare_json", compare_json, "scene"_a, "compare.json of one scene.");
  py::class_<HeldCore>(module, "OnOneCore", "In a `with`: this thread's work takes one core.")
      .def(py::init<>())
      .def("__enter__", [](HeldCore& self) { self.alone.emplace(); })
      .def("__exit__", [](HeldCore& self, const py::args&) { self.alone.reset(); });
  py::class_<SharedStop>(
      module, "Stop",
      "In a `with`, not nested: this thread's work ends at its next step after `request`.")
      .def(py::init<>())
      .def("request", [](const SharedStop& self) { self.source.request_stop(); })
      .def("__enter__", [](const SharedStop& self) { obey(self.source.get_token()); })
      .def("__exit__", [](const SharedStop&, const py::args&) { obey({}); });
}

}  // namespace nuno::python
