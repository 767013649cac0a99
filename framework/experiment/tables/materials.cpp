#include "base/text.hpp"
#include "experiment/tables/declarations.hpp"
#include "experiment/tables/tables.hpp"

namespace evodevo {
namespace {

constexpr std::size_t most_materials = 1000;

/// Adds a warning if a new material's name is similar to that of a base material. If the user meant the base material,
/// the file defines a new material instead of changing that one.
void warn_of_near_material(const std::string& name, Warnings& warnings) {
  std::vector<std::string> known;
  for (const auto& [known_name, material] : base_materials()) known.push_back(known_name);
  if (const std::string near = nearest(name, known); !near.empty())
    warnings.push_back("[materials." + name + "] defines a new material; if \"" + near +
                       "\" is meant, correct the name");
}

}  // namespace

void read_materials(TomlReader& top, Settings& settings, Warnings& warnings) {
  read_table(top, "materials", false, [&](TomlReader& materials) {
    const std::vector<std::string> names = materials.keys();
    if (names.size() > most_materials)
      top.fail("materials", "expected at most " + std::to_string(most_materials) + " materials");
    for (const std::string& name : names) {
      if (const std::string fault = text_fault(name); !fault.empty()) materials.report(name, "the name " + fault);
      if (!settings.materials.contains(name)) warn_of_near_material(name, warnings);
      read_table(materials, name, true, [&](TomlReader& t) { declare(t, settings.materials[name]); });
    }
  });
}

}  // namespace evodevo
