#include "experiment/tables/reference.hpp"

#include "experiment/experiment.hpp"
#include "experiment/tables/declarations.hpp"
#include "operators/reference.hpp"

namespace evodevo {
namespace {

/// The section of one table: its name in Markdown, one sentence, and the keys that `declare_keys` declares.
template <class DeclareKeys>
std::string section(const std::string& name, const std::string& sentence, const DeclareKeys& declare_keys) {
  Describer describer;
  declare_keys(describer);
  return heading_text(3, name) + sentence + "\n\n" + parameter_table(describer.found, "key");
}

/// The section of a table whose keys are the members of one object. The defaults are those of a new object.
template <class Object>
std::string section_of(const std::string& name, const std::string& sentence) {
  return section(name, sentence, [](Parameters& v) {
    Object object;
    declare(v, object);
  });
}

/// The section of all forces of a scene. Each name is that of the force and that of the key, such as "gravity.slope".
std::string section_of_scene() {
  std::vector<ParameterDescription> keys;
  Settings settings;
  for_each_force(settings, [&](std::string_view name, auto& force) {
    Describer describer;
    declare(describer, force.emplace());
    for (ParameterDescription& key : describer.found) {
      key.name = std::string(name) + "." + key.name;
      keys.push_back(std::move(key));
    }
  });
  return heading_text(3, "`[scene]`") +
         "The forces on a robot besides those of its springs: gravity (on a slope, the floor stays level and gravity "
         "is tilted), a floor at height 0 that pushes masses up (level or rough ground), friction between masses and "
         "the floor, damping of all velocities alike, the drag of a fluid on each mass, and a payload that every body "
         "carries from birth on. Each force is a table: `gravity.slope` is the key `slope` in `[scene.gravity]`. A "
         "force without a table is not computed, and a key that its table leaves out has the default.\n\n" +
         parameter_table(keys, "key");
}

}  // namespace

std::string experiment_reference() {
  Settings s;
  s.development.cycles = 100;  // the default of this key if there are operators
  Schedule schedule;
  double probability = Varied<Mutation>().probability;
  std::string text;
  text += section("`[experiment]`", "How long the run takes, and how many individuals live at once.",
                  [&](Parameters& v) { declare_run(v, s); });
  text += section("`[encoding]`", "The key that every encoding has in addition to `name` and its own parameters.",
                  [&](Parameters& v) { declare_mass(v, s); });
  text +=
      section("`[[mutation]]` and `[[crossover]]`",
              "The key that every mutation and crossover operator has in addition to `name` and its own parameters.",
              [&](Parameters& v) { declare_probability(v, probability); });
  text += section_of_scene();
  text += section("`[simulation]`", "How motion is computed, and on which device.", [&](Parameters& v) {
    declare_accuracy(v, s);
    declare_simulation(v, s);
  });
  text += section("`[development]`", "How long a body develops. Without this table, bodies do not develop.",
                  [&](Parameters& v) { declare_development(v, s); });
  text += section("`[[development.operator]]`",
                  "The keys that every devo operator has in addition to `name` and its own parameters.",
                  [&](Parameters& v) { declare_schedule(v, schedule); });
  text +=
      section("`[[fitness]]`", "The keys that every fitness operator has in addition to `name` and its own parameters.",
              [&](Parameters& v) {
                std::string over(name_of(Scored().over));
                declare_over(v, over);
                Over over_lives = Over::mean;
                declare_over_lives(v, over_lives);
              });
  text +=
      section("`[[scenario]]`",
              "A test of the robot, with a `name`; there may be several. Tables such as `[scenario.gravity]`, "
              "`[scenario.floor]` or `[scenario.payload]` have the keys of the tables of `[scene]`; what they leave "
              "out stays as in the scene. Without this table, robots are measured in the scene itself.",
              [&](Parameters& v) {
                Scenario scenario;
                declare_scenario(v, scenario);
              });
  text += section("`[selection]`",
                  "The keys that this table has in addition to `name` and the parameters of the operator, or to the "
                  "tables of two operators.",
                  [&](Parameters& v) { declare_remeasure(v, s); });
  text += section_of<IslandSettings>(
      "`[islands]`",
      "Several populations in one run, between which individuals migrate. Without this table, there is "
      "one population.");
  text += section("`[[island]]`",
                  "What is different on one island. Tables such as `[island.selection]`, `[[island.mutation]]` and "
                  "`[[island.crossover]]` replace all tables of this name.",
                  [&](Parameters& v) {
                    std::int64_t number = 1;
                    std::optional<double> seed;
                    declare_island_number(v, number);
                    declare_island(v, seed);
                  });
  text += section_of<Material>("`[materials.NAME]`",
                               "A material. The defaults apply to materials that evodevo does not know.");
  return text;
}

}  // namespace evodevo
