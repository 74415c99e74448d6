#pragma once

#include <pybind11/pybind11.h>

namespace nuno::python {

/// Adds the classes Backend and Simulation.
void add_backends(pybind11::module_& module);

/// Adds simulate, optimize and compare.
void add_searches(pybind11::module_& module);

}  // namespace nuno::python
