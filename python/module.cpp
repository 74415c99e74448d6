// The extension nuno._core: all of C++ that the package `nuno` shows.

#include <pybind11/pybind11.h>

#include <nuno/output.h>
#include <nuno/scene.h>

#include "backend.h"
#include "flight.h"
#include "scene.h"

namespace py = pybind11;

PYBIND11_MODULE(_core, module) {
  using namespace nuno;
  module.doc() = "What the package nuno shows of the C++ libraries.";
  module.attr("__version__") = NUNO_VERSION;
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError).doc() =
      "Bad input: the message names file, field, value and the rule that it breaks.";
  py::register_exception<OutputError>(module, "OutputError", PyExc_OSError).doc() =
      "An output that cannot be written; the message names it and says why.";
  py::register_exception<python::Diverged>(module, "DivergedError", PyExc_RuntimeError).doc() =
      "A flight that diverged; the message says at which step and why.";
  python::add_scenes(module);
  python::add_flights(module);
  python::add_backends(module);
  python::add_searches(module);
}
