#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <nuno/backend.h>
#include <nuno/gains.h>

#include <string>
#include <vector>

namespace nuno::python {

namespace py = pybind11;

/// Numbers as numpy keeps them: rows one after another.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// [points × dimension] of Python as [dimension × points], which is the same memory. Throws
/// InputError, which begins with `at`, for an array of another shape; 0 allows any dimension or
/// number of points.
Points points_of(const Array& array, Index dimension, Index points, const std::string& at);

/// The same of several shapes [shapes × points × dimension].
std::vector<Points> shapes_of(const Array& array, Index dimension, Index points,
                              const std::string& at);

/// Points that `owner` holds as [points × dimension], read-only, without a copy.
py::array view(const Points& points, py::handle owner);

/// The numbers of `owner` in this shape, read-only, without a copy.
py::array view(const double* numbers, std::vector<py::ssize_t> shape, py::handle owner);

/// Numbers that become an array's own, without a copy.
py::array owned(std::vector<double> numbers, std::vector<py::ssize_t> shape);

/// [gains], or [gains × groups], as gains; `at` names them in messages.
std::vector<Gains> gains_of(const Array& array, const Backend& backend, const std::string& at);

}  // namespace nuno::python
