#include "body_json.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "text.hpp"
#include "toml_reader.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

/// Reads the parts of one file; every complaint begins with the file and the part's place in it.
class BodyReader {
 public:
  explicit BodyReader(std::string file) : file_(std::move(file)) {}

  Body read() {
    const Json root = parse();
    Body body;
    each(root, "materials", [&](const Json& item, const std::string& at) {
      body.materials.push_back({number(item, at, "stiffness", 0), number(item, at, "amplitude", 0),
                                number(item, at, "frequency", 0), number(item, at, "phase", lowest)});
    });
    each(root, "masses", [&](const Json& item, const std::string& at) {
      Mass mass;
      mass.rest = place(item, at);
      mass.mass = number(item, at, "mass", std::numeric_limits<double>::min());
      if (item.contains("material"))
        mass.material = static_cast<std::int32_t>(index(item, at, "material", body.materials.size()));
      body.masses.push_back(mass);
    });
    if (body.masses.empty()) fail("masses", "a body has at least one");
    std::set<std::pair<std::uint32_t, std::uint32_t>> joined;
    each(root, "springs", [&](const Json& item, const std::string& at) {
      const Spring spring{index(item, at, "a", body.masses.size()), index(item, at, "b", body.masses.size()),
                          number(item, at, "rest_length", 0), index(item, at, "material", body.materials.size())};
      if (spring.a == spring.b) fail(at, "joins mass " + std::to_string(spring.a) + " to itself");
      if (!joined.insert(std::minmax(spring.a, spring.b)).second)
        fail(at, "masses " + std::to_string(spring.a) + " and " + std::to_string(spring.b) + " are joined already");
      body.springs.push_back(spring);
    });
    return body;
  }

 private:
  static constexpr double lowest = std::numeric_limits<double>::lowest();

  [[noreturn]] void fail(const std::string& at, const std::string& message) const {
    throw ConfigError(file_ + ": " + (at.empty() ? "" : at + ": ") + message);
  }

  Json parse() const {
    std::ifstream stream(file_);
    if (!stream) fail("", std::string("cannot be read: ") + std::strerror(errno));
    if (std::filesystem::is_directory(file_)) fail("", "cannot be read: it is a folder");
    try {
      return Json::parse(stream);
    } catch (const Json::exception& error) {
      fail("", std::string("is not JSON: ") + error.what());
    }
  }

  const Json& member(const Json& item, const std::string& at, const std::string& key) const {
    if (!item.is_object() || !item.contains(key)) fail(at, "\"" + key + "\" is missing");
    return item.at(key);
  }

  template <class Read>
  void each(const Json& root, const std::string& key, const Read& read) const {
    const Json& list = member(root, "", key);
    if (!list.is_array()) fail(key, "expected a list");
    for (std::size_t i = 0; i < list.size(); ++i) read(list[i], key + "[" + std::to_string(i) + "]");
  }

  double finite(const Json& value, const std::string& at, double least) const {
    if (!value.is_number()) fail(at, "expected a number, found " + value.dump());
    const double number = value.get<double>();
    if (!std::isfinite(number) || number < least)
      fail(at, value.dump() + " is out of range; expected " +
                   (least == lowest ? "a finite number" : "at least " + to_text(least)));
    return number;
  }

  double number(const Json& item, const std::string& at, const std::string& key, double least) const {
    return finite(member(item, at, key), at + "." + key, least);
  }

  Vec3 place(const Json& item, const std::string& at) const {
    const Json& list = member(item, at, "position");
    const std::string here = at + ".position";
    if (!list.is_array() || list.size() != 3) fail(here, "expected three numbers");
    return {finite(list[0], here, lowest), finite(list[1], here, lowest), finite(list[2], here, lowest)};
  }

  std::uint32_t index(const Json& item, const std::string& at, const std::string& key, std::size_t count) const {
    const Json& value = member(item, at, key);
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count)
      fail(at + "." + key, value.dump() + " is not an index below " + std::to_string(count));
    return value.get<std::uint32_t>();
  }

  std::string file_;
};

}  // namespace

std::string body_to_json(const Body& body, const std::vector<Vec3>& places, const std::vector<std::string>& names) {
  Json masses = Json::array(), springs = Json::array(), materials = Json::array();
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    Json mass = {{"position", {places[i].x, places[i].y, places[i].z}}, {"mass", body.masses[i].mass}};
    if (body.masses[i].material != no_material) mass["material"] = body.masses[i].material;
    masses.push_back(std::move(mass));
  }
  for (const Spring& spring : body.springs)
    springs.push_back(
        {{"a", spring.a}, {"b", spring.b}, {"rest_length", spring.rest_length}, {"material", spring.material}});
  for (std::size_t i = 0; i < body.materials.size(); ++i) {
    Json material;
    if (i < names.size()) material["name"] = names[i];
    material["stiffness"] = body.materials[i].stiffness;
    material["amplitude"] = body.materials[i].amplitude;
    material["frequency"] = body.materials[i].frequency;
    material["phase"] = body.materials[i].phase;
    materials.push_back(std::move(material));
  }
  return Json{{"masses", std::move(masses)}, {"springs", std::move(springs)}, {"materials", std::move(materials)}}.dump(
      1);
}

Body read_body(const std::string& file) { return BodyReader(file).read(); }

}  // namespace evodevo
