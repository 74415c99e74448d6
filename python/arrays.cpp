#include "arrays.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <span>
#include <utility>

namespace nuno::python {
namespace {

std::string shape_of_array(const py::array& array) {
  return fmt::format("({})", fmt::join(array.shape(), array.shape() + array.ndim(), ", "));
}

std::string wanted(Index points, Index dimension) {
  return fmt::format("({}, {})", points ? fmt::format("{}", points) : "points",
                     dimension ? fmt::format("{}", dimension) : "2 or 3");
}

bool fits(const Array& array, py::ssize_t axis, Index size) {
  return size == 0 || array.shape(axis) == size;
}

}  // namespace

Points points_of(const Array& array, Index dimension, Index points, const std::string& at) {
  const bool right = array.ndim() == 2 && fits(array, 0, points) && fits(array, 1, dimension) &&
                     (array.shape(1) == 2 || array.shape(1) == 3);
  if (!right) {
    throw InputError(fmt::format("{}: an array of shape {} is not one of {}", at,
                                 shape_of_array(array), wanted(points, dimension)));
  }
  return Eigen::Map<const Points>(array.data(), array.shape(1), array.shape(0));
}

std::vector<Points> shapes_of(const Array& array, Index dimension, Index points,
                              const std::string& at) {
  if (array.ndim() != 3 || !fits(array, 1, points) || !fits(array, 2, dimension)) {
    throw InputError(fmt::format("{}: an array of shape {} is not one of (shapes, {}, {})", at,
                                 shape_of_array(array), points, dimension));
  }
  std::vector<Points> shapes;
  for (py::ssize_t k = 0; k < array.shape(0); ++k) {
    shapes.emplace_back(Eigen::Map<const Points>(array.data(k), dimension, points));
    if (!shapes.back().allFinite()) {
      throw InputError(fmt::format("{}/{}: has a number that is not finite", at, k));
    }
  }
  return shapes;
}

py::array view(const double* numbers, std::vector<py::ssize_t> shape, py::handle owner) {
  py::array_t<double> array(std::move(shape), numbers, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::array view(const Points& points, py::handle owner) {
  return view(points.data(), {points.cols(), points.rows()}, owner);
}

py::array owned(std::vector<double> numbers, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::vector<double>>(std::move(numbers));
  const double* data = kept->data();
  const py::capsule owner(kept.get(),
                          [](void* held) { delete static_cast<std::vector<double>*>(held); });
  static_cast<void>(kept.release());  // the capsule's now
  return py::array_t<double>(std::move(shape), data, owner);
}

std::vector<Gains> gains_of(const Array& array, const Backend& backend, const std::string& at) {
  const py::ssize_t groups = array.ndim() == 2 ? array.shape(1) : 1;
  if ((array.ndim() != 1 && array.ndim() != 2) || groups < 1 || groups > most_groups) {
    throw InputError(fmt::format(
        "{}: an array of shape {} is not one of (gains,) or (gains, groups), 1 … {} groups", at,
        shape_of_array(array), most_groups));
  }
  const Index particles = backend.cloth().particles();
  const Index fewest =
      backend.problem().is_sheet() ? fewest_sheet_particles(groups) : fewest_particles(groups);
  if (groups > 1 && particles < fewest) {
    throw InputError(fmt::format("{}: {} particles are not >= {}, the fewest for {} groups", at,
                                 particles, fewest, groups));
  }
  std::vector<Gains> gains;
  const auto step = static_cast<std::size_t>(groups);
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    const std::span<const double> row(array.data(i), step);
    for (const double gain : row) {
      if (!(gain >= 0 && std::isfinite(gain))) {
        throw InputError(fmt::format("{}: {} is not >= 0", at, gain));
      }
    }
    gains.push_back(Gains::of_groups(row));
  }
  return gains;
}

}  // namespace nuno::python
