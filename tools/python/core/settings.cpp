#include "settings.hpp"

#include <nlohmann/json.hpp>
#include <optional>

#include "base/json_text.hpp"
#include "base/text.hpp"
#include "experiment/tables/tables.hpp"

namespace evodevo::python {
namespace {

namespace py = pybind11;

constexpr const char* caller = "simulate()";  ///< the origin of the settings in messages

std::string toml_of(py::handle value, const std::string& key);

/// Returns an inline table.
std::string toml_of(const py::dict& table, const std::string& key) {
  std::string text;
  for (const auto& [name, value] : table) {
    const std::string inner = key + "." + std::string(py::str(name));
    text += (text.empty() ? "" : ", ") + json_text(std::string(py::str(name))) + " = " + toml_of(value, inner);
  }
  return "{" + text + "}";
}

/// Returns a list.
std::string toml_of(const py::sequence& items, const std::string& key) {
  std::string text;
  for (const py::handle item : items) text += (text.empty() ? "" : ", ") + toml_of(item, key);
  return "[" + text + "]";
}

/// Returns a number of Python as TOML. Arrays without dimensions have functions of whole numbers, too, whatever they
/// hold. What is too large for a whole number of TOML becomes a real one.
std::string number_to_toml(py::handle value) {
  const auto whole =
      py::reinterpret_steal<py::object>(PyIndex_Check(value.ptr()) ? PyNumber_Index(value.ptr()) : nullptr);
  if (!whole) PyErr_Clear();
  int beyond = 0;
  if (whole) PyLong_AsLongLongAndOverflow(whole.ptr(), &beyond);
  return py::repr(whole && beyond == 0 ? whole : py::object(py::float_(value.cast<py::object>())));
}

/// Returns a value of Python, such as a number or a dictionary, as TOML, unless it is of none of the kinds that TOML
/// has.
std::optional<std::string> converted(py::handle value, const std::string& key) {
  if (py::isinstance<py::dict>(value)) return toml_of(value.cast<py::dict>(), key);
  if (py::isinstance<py::str>(value)) return json_text(value.cast<std::string>());
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value))
    return toml_of(value.cast<py::sequence>(), key);
  if (PyNumber_Check(value.ptr()) != 0) return number_to_toml(value);
  return std::nullopt;
}

std::string toml_of(py::handle value, const std::string& key) {
  try {
    if (const auto text = converted(value, key)) return *text;
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_TypeError) && !error.matches(PyExc_ValueError) && !error.matches(PyExc_OverflowError))
      throw;
  } catch (const py::cast_error&) {  // a text that is not Unicode
  }
  throw ConfigError(std::string(caller) + ": " + key + ": " + std::string(py::repr(value)) +
                    "; expected a number, a text, a truth value, a list or a dictionary");
}

}  // namespace

Experiment experiment_with(const py::dict& scene, const py::dict& simulation) {
  toml::table root = parse_toml(
      "experiment = {}\nscene = " + toml_of(scene, "scene") + "\nsimulation = " + toml_of(simulation, "simulation"),
      caller);
  TomlReader top(root, "");
  Experiment experiment;
  static_cast<Settings&>(experiment) = read_settings(top, Bodies::given, experiment.warnings);
  experiment.device_location = caller;
  return experiment;
}

}  // namespace evodevo::python
