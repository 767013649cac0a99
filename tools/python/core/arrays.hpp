// Conversions between NumPy arrays and vectors.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo::python {

namespace py = pybind11;

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Shape = std::vector<py::ssize_t>;

inline constexpr py::ssize_t any_size = -1;

/// Returns a Python object as an array of numbers. Throws ValueError that begins with `place` if it has another shape;
/// any_size stands for any number.
Numbers numbers_in(py::handle object, const std::string& place, const Shape& shape);

/// Returns a new array.
template <class T>
py::array_t<T> array_of(std::span<const T> values, Shape shape) {
  py::array_t<T> array(std::move(shape));
  if (!values.empty()) std::memcpy(array.mutable_data(), values.data(), values.size_bytes());
  return array;
}
template <class T>
py::array_t<T> array_of(const std::vector<T>& values) {
  return array_of(std::span(values), {static_cast<py::ssize_t>(values.size())});
}
/// Returns a new array [vectors, 3].
py::array_t<double> array_of(const std::vector<Vec3>& vectors);

}  // namespace evodevo::python
