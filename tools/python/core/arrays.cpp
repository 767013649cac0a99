#include "arrays.hpp"

namespace evodevo::python {
namespace {

std::string text_of(const Shape& shape) {
  std::string text;
  for (const py::ssize_t size : shape)
    text += (text.empty() ? "" : ", ") + (size == any_size ? "any" : std::to_string(size));
  return "[" + text + "]";
}

bool fits(const Numbers& array, const Shape& shape) {
  if (array.ndim() != static_cast<py::ssize_t>(shape.size())) return false;
  for (std::size_t i = 0; i < shape.size(); ++i)
    if (shape[i] != any_size && shape[i] != array.shape(static_cast<py::ssize_t>(i))) return false;
  return true;
}

}  // namespace

Numbers numbers_in(py::handle object, const std::string& place, const Shape& shape) {
  const Numbers array = Numbers::ensure(object);
  if (!array) {
    PyErr_Clear();
    throw py::value_error(place + ": expected an array of numbers of the shape " + text_of(shape));
  }
  if (fits(array, shape)) return array;
  const Shape found(array.shape(), array.shape() + array.ndim());
  throw py::value_error(place + ": has the shape " + text_of(found) + "; expected " + text_of(shape));
}

py::array_t<double> array_of(const std::vector<Vec3>& vectors) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  py::array_t<double> array(Shape{static_cast<py::ssize_t>(vectors.size()), 3});
  if (!vectors.empty()) std::memcpy(array.mutable_data(), vectors.data(), vectors.size() * sizeof(Vec3));
  return array;
}

}  // namespace evodevo::python
