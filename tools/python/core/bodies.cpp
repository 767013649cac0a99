#include "bodies.hpp"

#include <cmath>
#include <limits>

#include "base/text.hpp"

namespace evodevo::python {
namespace {

constexpr double lowest = std::numeric_limits<double>::lowest();
constexpr double above_zero = std::numeric_limits<double>::min();

/// The arrays of one body. Every error message begins with the body and the attribute.
class BodyReader {
 public:
  BodyReader(py::handle body, std::string place) : object_(body), place_(std::move(place)) {}

  GivenBody read() {
    read_materials();
    read_masses();
    read_springs();
    if (object_.attr("velocities").is_none()) return {std::move(body_), std::nullopt};
    State state = read_state();
    return {std::move(body_), std::move(state)};
  }

 private:
  /// The numbers of an attribute, row by row.
  class Attribute {
   public:
    Attribute(py::handle object, std::string place, const Shape& shape)
        : place_(std::move(place)), array_(numbers_in(object, place_, shape)) {}

    std::size_t size() const { return static_cast<std::size_t>(array_.shape(0)); }

    /// Returns a number. Throws ValueError if it is not finite, below `least` or above `most`.
    double number(std::size_t row, std::size_t column = 0, double least = lowest, double most = -lowest) const {
      const double value = array_.data()[row * columns() + column];
      if (std::isfinite(value) && value >= least && value <= most) return value;
      fail(row, to_text(value) + "; expected " +
                    (least == lowest       ? "a finite number"
                     : most < -lowest      ? to_text(least) + " to " + to_text(most)
                     : least == above_zero ? "a finite number above 0"
                                           : "a finite number of at least " + to_text(least)));
    }

    Vec3 vector(std::size_t row) const { return {number(row, 0), number(row, 1), number(row, 2)}; }

    /// Returns an index from `least` to count - 1.
    std::int64_t index(std::size_t row, std::size_t column, std::size_t count, std::int64_t least = 0) const {
      const double value = array_.data()[row * columns() + column];
      if (value == std::floor(value) && value >= static_cast<double>(least) && value < static_cast<double>(count))
        return static_cast<std::int64_t>(value);
      fail(row, to_text(value) + "; expected an index from " + std::to_string(least) + " to " +
                    std::to_string(static_cast<std::int64_t>(count) - 1));
    }

    [[noreturn]] void fail(std::size_t row, const std::string& message) const {
      throw py::value_error(place_ + "[" + std::to_string(row) + "]: " + message);
    }

   private:
    std::size_t columns() const { return array_.ndim() == 1 ? 1 : static_cast<std::size_t>(array_.shape(1)); }

    std::string place_;
    Numbers array_;
  };

  Attribute attribute(const char* name, const Shape& shape) const {
    return {object_.attr(name), place_ + "." + name, shape};
  }
  Shape for_each_mass() const { return {static_cast<py::ssize_t>(body_.masses.size())}; }

  void read_materials() {
    const py::object table = object_.attr("materials");
    const Shape rows{static_cast<py::ssize_t>(py::len(table))};
    body_.materials.resize(py::len(table));
    const auto read = [&](const char* name, double Material::*parameter, double least, double most = -lowest) {
      const py::str key(name);
      const Attribute column(table[key], place_ + ".materials." + name, rows);
      for (std::size_t i = 0; i < body_.materials.size(); ++i)
        body_.materials[i].*parameter = column.number(i, 0, least, most);
    };
    read("stiffness", &Material::stiffness, 0);
    read("amplitude", &Material::amplitude, 0, largest_amplitude);
    read("frequency", &Material::frequency, 0);
    read("phase", &Material::phase, lowest);
    read("damping", &Material::damping, 0);
  }

  void read_masses() {
    const Attribute positions = attribute("positions", {any_size, 3});
    if (positions.size() == 0) throw py::value_error(place_ + ".positions: is empty; a body has at least one mass");
    body_.masses.resize(positions.size());
    const Attribute masses = attribute("masses", for_each_mass()),
                    materials = attribute("mass_materials", for_each_mass());
    for (std::size_t i = 0; i < body_.masses.size(); ++i) {
      Mass& mass = body_.masses[i];
      mass.rest = positions.vector(i);
      mass.mass = masses.number(i, 0, 0);
      mass.material = static_cast<std::int32_t>(materials.index(i, 0, body_.materials.size(), no_material));
    }
    if (std::ranges::none_of(body_.masses, [](const Mass& mass) { return mass.mass > 0; }))
      throw py::value_error(place_ +
                            ".masses: all are 0 kg, and a mass of 0 kg is held in place; give one of them a mass");
  }

  void read_springs() {
    const Attribute ends = attribute("springs", {any_size, 2});
    const Shape for_each_spring{static_cast<py::ssize_t>(ends.size())};
    const Attribute lengths = attribute("rest_lengths", for_each_spring),
                    materials = attribute("material_of", for_each_spring),
                    factors = attribute("stiffness_factors", for_each_spring);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const auto end = [&](std::size_t column) {
        return static_cast<std::uint32_t>(ends.index(i, column, body_.masses.size()));
      };
      Spring spring{end(0), end(1), lengths.number(i, 0, 0),
                    static_cast<std::uint32_t>(materials.index(i, 0, body_.materials.size()))};
      spring.stiffness_factor = factors.number(i, 0, above_zero);
      if (spring.a == spring.b) ends.fail(i, "joins mass " + std::to_string(spring.a) + " to itself; remove it");
      body_.springs.push_back(spring);
    }
  }

  State read_state() const {
    State state;
    const Attribute velocities = attribute("velocities", {for_each_mass()[0], 3});
    for (std::size_t i = 0; i < body_.masses.size(); ++i) {
      state.position.push_back(body_.masses[i].rest);
      state.velocity.push_back(velocities.vector(i));
    }
    state.time = number("time", 0);
    if (!object_.attr("start_energy").is_none()) state.start_energy = number("start_energy", lowest);
    return state;
  }

  double number(const char* name, double least) const {
    const double value = object_.attr(name).cast<double>();
    if (!std::isfinite(value) || value < least)
      throw py::value_error(place_ + "." + name + ": " + to_text(value) + "; expected a finite number" +
                            (least == lowest ? "" : " of at least " + to_text(least)));
    return value;
  }

  py::handle object_;
  std::string place_;
  Body body_;
};

/// Returns a new array with one number for each of some items.
template <class T, class Items, class Get>
py::array_t<T> column_of(const Items& items, const Get& get) {
  std::vector<T> column;
  for (const auto& item : items) column.push_back(static_cast<T>(get(item)));
  return array_of(column);
}

py::dict materials_of(const Body& body, const std::vector<std::string>& names) {
  const auto column = [&](double Material::*parameter) {
    return column_of<double>(body.materials, [&](const Material& material) { return material.*parameter; });
  };
  py::dict materials;
  py::list shown;
  for (std::size_t i = 0; i < body.materials.size(); ++i)
    shown.append(i < names.size() ? py::object(py::str(names[i])) : py::object(py::none()));
  materials["name"] = shown;
  materials["stiffness"] = column(&Material::stiffness);
  materials["amplitude"] = column(&Material::amplitude);
  materials["frequency"] = column(&Material::frequency);
  materials["phase"] = column(&Material::phase);
  materials["damping"] = column(&Material::damping);
  return materials;
}

}  // namespace

GivenBody body_from(py::handle body, const std::string& place) { return BodyReader(body, place).read(); }

py::object body_to_python(const BuiltBody& built, const std::vector<std::string>& material_names) {
  const Body& body = built.body;
  std::vector<Vec3> positions;
  for (const Mass& mass : body.masses) positions.push_back(mass.rest);
  std::vector<std::int64_t> springs;
  for (const Spring& spring : body.springs) springs.insert(springs.end(), {spring.a, spring.b});
  using py::literals::operator""_a;
  return py::module_::import("evodevo").attr("Body")(
      "positions"_a = array_of(positions),
      "springs"_a =
          array_of(std::span<const std::int64_t>(springs), {static_cast<py::ssize_t>(body.springs.size()), 2}),
      "masses"_a = column_of<double>(body.masses, [](const Mass& mass) { return mass.mass; }),
      "materials"_a = materials_of(body, material_names),
      "rest_lengths"_a = column_of<double>(body.springs, [](const Spring& spring) { return spring.rest_length; }),
      "material_of"_a = column_of<std::int64_t>(body.springs, [](const Spring& spring) { return spring.material; }),
      "stiffness_factors"_a =
          column_of<double>(body.springs, [](const Spring& spring) { return spring.stiffness_factor; }),
      "mass_materials"_a = column_of<std::int64_t>(body.masses, [](const Mass& mass) { return mass.material; }),
      "identities"_a = column_of<std::uint64_t>(built.identities, [](std::uint64_t identity) { return identity; }));
}

}  // namespace evodevo::python
