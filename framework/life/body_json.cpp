#include "life/body_json.hpp"

#include <algorithm>
#include <limits>

#include "base/json_input.hpp"
#include "life/body_building.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

constexpr double lowest = std::numeric_limits<double>::lowest();

/// Reads the parts of one file. Every error message begins with the file and the place in it.
class BodyReader {
 public:
  explicit BodyReader(const std::string& file) : input_(file) {}

  GivenBody read() {
    const Json root = input_.read();
    input_.expect(root, "", {"masses", "springs", "materials", "time", "start_energy"});
    is_alive_ = root.contains("time");
    read_materials(root);
    read_masses(root);
    read_springs(root);
    if (!is_alive_ && root.contains("start_energy")) refuse_of_newborn("start_energy");
    if (!is_alive_) return {std::move(body_), std::nullopt, std::move(identities_)};
    state_.position = rest_positions(body_);
    state_.time = input_.number(root, "", "time", 0);
    if (root.contains("start_energy")) state_.start_energy = input_.number(root, "", "start_energy", lowest);
    return {std::move(body_), std::move(state_), std::move(identities_)};
  }

 private:
  void read_materials(const Json& root) {
    input_.each(root, "materials", [&](const Json& item, const std::string& at) {
      input_.expect(item, at, {"name", "stiffness", "amplitude", "frequency", "phase", "damping"});
      if (item.contains("name") && !item.at("name").is_string()) input_.fail(at + ".name", "expected a text");
      body_.materials.push_back({input_.number(item, at, "stiffness", 0),
                                 input_.number(item, at, "amplitude", 0, largest_amplitude),
                                 input_.number(item, at, "frequency", 0), input_.number(item, at, "phase", lowest),
                                 item.contains("damping") ? input_.number(item, at, "damping", 0) : 0.0});
    });
  }

  void read_masses(const Json& root) {
    input_.each(root, "masses", [&](const Json& item, const std::string& at) {
      input_.expect(item, at, {"position", "velocity", "mass", "material", "identity"});
      Mass mass;
      mass.rest = vector(item, at, "position");
      mass.mass = input_.number(item, at, "mass", 0);
      if (item.contains("material"))
        mass.material = static_cast<std::int32_t>(input_.index(item, at, "material", body_.materials.size()));
      const bool has_identity = item.contains("identity");
      if (has_identity && !item.at("identity").is_number_unsigned())
        input_.fail(at + ".identity", "expected a whole number from 0 to 18446744073709551615");
      identities_.push_back(has_identity ? item.at("identity").get<std::uint64_t>() : body_.masses.size());
      body_.masses.push_back(mass);
      if (!is_alive_ && item.contains("velocity")) refuse_of_newborn(at + ".velocity");
      state_.velocity.push_back(item.contains("velocity") ? vector(item, at, "velocity") : Vec3{});
    });
    if (body_.masses.empty()) input_.fail("masses", "is empty; a body has at least one mass");
    if (std::ranges::none_of(body_.masses, [](const Mass& mass) { return mass.mass > 0; }))
      input_.fail("masses", "all are 0 kg, and a mass of 0 kg is held in place; give one of them a mass");
  }

  void read_springs(const Json& root) {
    const std::size_t masses = body_.masses.size();
    input_.each(root, "springs", [&](const Json& item, const std::string& at) {
      input_.expect(item, at, {"a", "b", "rest_length", "material", "stiffness_factor"});
      Spring spring{input_.index(item, at, "a", masses), input_.index(item, at, "b", masses),
                    input_.number(item, at, "rest_length", 0),
                    input_.index(item, at, "material", body_.materials.size())};
      if (item.contains("stiffness_factor"))
        spring.stiffness_factor = input_.number(item, at, "stiffness_factor", std::numeric_limits<double>::min());
      if (spring.a == spring.b) input_.fail(at, "joins mass " + std::to_string(spring.a) + " to itself");
      body_.springs.push_back(spring);
    });
  }

  Vec3 vector(const Json& item, const std::string& at, const std::string& key) const {
    const Json& list = input_.member(item, at, key);
    const std::string here = at + "." + key;
    if (!list.is_array() || list.size() != 3) input_.fail(here, "expected three numbers");
    return {input_.finite(list[0], here, lowest), input_.finite(list[1], here, lowest),
            input_.finite(list[2], here, lowest)};
  }

  [[noreturn]] void refuse_of_newborn(const std::string& at) const {
    input_.fail(
        at, "a body without \"time\" is born at rest; add \"time\", its time since birth in s, or leave this key out");
  }

  JsonInput input_;
  Body body_;
  State state_;
  std::vector<std::uint64_t> identities_;
  bool is_alive_ = false;  ///< whether the body is in the middle of its life
};

Json numbers(Vec3 v) { return {v.x, v.y, v.z}; }

Json masses_json(const GivenBody& given) {
  Json masses = Json::array();
  for (std::size_t i = 0; i < given.body.masses.size(); ++i) {
    const Mass& mass = given.body.masses[i];
    Json written = {{"position", numbers(given.state ? given.state->position[i] : mass.rest)}};
    if (given.state) written["velocity"] = numbers(given.state->velocity[i]);
    written["mass"] = mass.mass;
    if (mass.material != no_material) written["material"] = mass.material;
    if (!given.identities.empty()) written["identity"] = given.identities[i];
    masses.push_back(std::move(written));
  }
  return masses;
}

Json springs_json(const Body& body) {
  Json springs = Json::array();
  for (const Spring& spring : body.springs) {
    Json written = {
        {"a", spring.a}, {"b", spring.b}, {"rest_length", spring.rest_length}, {"material", spring.material}};
    if (spring.stiffness_factor != 1) written["stiffness_factor"] = spring.stiffness_factor;
    springs.push_back(std::move(written));
  }
  return springs;
}

Json materials_json(const Body& body, const std::vector<std::string>& names) {
  Json materials = Json::array();
  for (std::size_t i = 0; i < body.materials.size(); ++i) {
    Json material;
    if (i < names.size()) material["name"] = names[i];
    material["stiffness"] = body.materials[i].stiffness;
    material["amplitude"] = body.materials[i].amplitude;
    material["frequency"] = body.materials[i].frequency;
    material["phase"] = body.materials[i].phase;
    if (body.materials[i].damping != 0) material["damping"] = body.materials[i].damping;
    materials.push_back(std::move(material));
  }
  return materials;
}

}  // namespace

std::string body_to_json(const GivenBody& given, const std::vector<std::string>& material_names) {
  Json root = {{"masses", masses_json(given)},
               {"springs", springs_json(given.body)},
               {"materials", materials_json(given.body, material_names)}};
  if (given.state) {
    root["time"] = given.state->time;
    root["start_energy"] = given.state->start_energy;
  }
  return root.dump(1);
}

GivenBody read_body(const std::string& file) { return BodyReader(file).read(); }

}  // namespace evodevo
