#include "experiment/experiment.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "base/philox.hpp"
#include "base/text.hpp"
#include "experiment/islands/island_tables.hpp"
#include "experiment/tables/operators.hpp"
#include "experiment/tables/plugins.hpp"
#include "experiment/tables/tables.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

EncodingContext encoding_context(const Settings& settings) {
  EncodingContext context;
  for (const auto& [name, material] : settings.materials) {
    context.material_names.push_back(name);
    context.materials.push_back(material);
  }
  context.mass = settings.mass;
  context.philox = philox;
  return context;
}

/// Loads the libraries of operators that the experiment may use. Adds a warning for each library that cannot be used.
Registry registry_of(const PluginsTable& plugins, Warnings& warnings) {
  Registry registry(plugins.search_path());
  for (const FailedLibrary& failed : registry.failed())
    warnings.push_back("unusable library " + printable(failed.file.string()) + ": " + failed.reason);
  return registry;
}

/// Adds warnings of what keeps robots from walking, and genomes from being inherited.
void warn_of_vain_settings(Experiment& experiment) {
  const auto falls = [](const Scene& scene) {
    return scene.gravity && scene.gravity->acceleration > 0 && !scene.floor;
  };
  const std::string without_end =
      ": there is gravity, but no floor, so that robots fall without end; add a floor or "
      "remove the gravity";
  if (falls(experiment.scene)) experiment.warnings.push_back("[scene]" + without_end);
  for (const Scenario& scenario : experiment.scenarios)
    if (falls(scenario.scene) && !falls(experiment.scene))
      experiment.warnings.push_back("scenario " + scenario.name + without_end);
  if (experiment.develops_by_operators() && experiment.development.draws == DrawsBy::individual &&
      experiment.lives == 1)
    experiment.warnings.push_back(
        "development.draws = \"individual\": each robot has luck of its own, and with experiment.lives = 1 a score "
        "that no "
        "later life repeats and no child inherits; set development.draws = \"inherited\", or more lives with "
        "development.draws_between_lives = \"new\"");
  if (const std::int64_t births = experiment.newborns(); experiment.random_individuals == births)
    experiment.warnings.push_back(
        "experiment.random_individuals = " + std::to_string(births) +
        ": all that are born in each generation are random, so that nobody has children; set " +
        (births > 1 ? "less than " + std::to_string(births) : "0") + " unless random search is what you want");
}

Experiment compose(const toml::table& root, const ExperimentSource& source) {
  ErrorCollector errors;
  TomlReader top(root, "", {}, &errors);
  top.expect({"experiment", "encoding", "mutation", "crossover", "scene", "simulation", "development", "fitness",
              "scenario", "selection", "materials", "islands", "island", "plugins"});
  Experiment experiment;
  const PluginsTable plugins(root, source);
  plugins.check(top, experiment.warnings);
  experiment.plugin_folders = plugins.recorded_path(top);
  const Registry registry = registry_of(plugins, experiment.warnings);
  const Warnings registry_faults = experiment.warnings;

  static_cast<Settings&>(experiment) =
      read_settings(top, source.grows_bodies ? Bodies::grown : Bodies::given, experiment.warnings);
  check_island_tables(top, experiment);
  if (!experiment.start.empty())  // absolute in the record of a run, so that it means the same elsewhere
    experiment.start = (fs::absolute(source.file).parent_path() / experiment.start).lexically_normal().string();
  experiment.name = printable(fs::path(source.file).stem().string());
  const toml::node_view device = root.at_path("simulation.device");
  experiment.device_location = device ? location_of(device.node()->source()) : top.location("simulation");
  experiment.gpus = source.gpus;
  experiment.context = encoding_context(experiment);

  toml::table record = to_toml(experiment);
  toml::array folders;
  for (const fs::path& folder : experiment.plugin_folders) folders.push_back(folder.string());
  if (!folders.empty()) record.insert("plugins", toml::table{{"paths", std::move(folders)}});
  read_operators(top, OperatorFactory(registry, registry_faults, experiment), source, experiment, record);
  check_lives(top, experiment, experiment.develops_by_operators());
  errors.throw_errors();
  warn_of_vain_settings(experiment);
  std::ostringstream text;
  text << record << '\n';
  experiment.resolved = text.str();
  return experiment;
}

toml::table with_overrides(toml::table root, const ExperimentSource& source) {
  for (const Override& change : source.overrides) apply_override(change, root);
  return root;
}

/// Throws ConfigError if the genomes of an island are not those of the first one, so that it could not migrate.
void check_same_genomes(const Experiment& first, const Experiment& island, const ExperimentSource& source) {
  if (island.layout == first.layout) return;
  throw ConfigError(source.file + ": island " + std::to_string(island.island) + " has genomes with the sections " +
                    joined(island.layout.sections) + ", but island 1 has genomes with " +
                    joined(first.layout.sections) +
                    ", or their genes differ; give all islands the same mutation operators with genes of their own");
}

}  // namespace

Experiment::~Experiment() {
  const auto end = [&](std::string_view kind, std::size_t index, auto& op) {
    const InOperator in_its_destructor({call_of(kind, index).title});
    op.reset();
  };
  end(Encoding::kind, 0, encoding);
  end(Selection::kind, 0, selection);
  end(Selection::kind, 1, parent_selection);
  for (std::size_t i = 0; i < mutations.size(); ++i) end(Mutation::kind, i, mutations[i].op);
  for (std::size_t i = 0; i < crossovers.size(); ++i) end(Crossover::kind, i, crossovers[i].op);
  for (std::size_t i = 0; i < devo.size(); ++i) end(Devo::kind, i, devo[i].op);
  for (std::size_t i = 0; i < fitness.size(); ++i) end(Fitness::kind, i, fitness[i].op);
}

OperatorCall Experiment::call_of(std::string_view kind, std::size_t index, CallSubject subject) const {
  const auto use =
      std::find_if(uses.begin(), uses.end(), [&](const OperatorUse& one) { return one.kind == kind && index-- == 0; });
  return {use == uses.end() ? nullptr : use->title, subject, seed, kind};
}

RecordRequest devo_request(const Experiment& experiment, std::size_t index) {
  return call_operator(experiment.call_of(Devo::kind, index), [&] { return experiment.devo.at(index).op->observes(); });
}

RecordRequest cycle_request(const Experiment& experiment, std::int64_t cycle, std::size_t first) {
  RecordRequest all;
  if (experiment.development.control == Control::no_change) return all;
  for (std::size_t i = first; i < experiment.devo.size(); ++i) {
    if (!experiment.devo[i].schedule.contains(cycle)) continue;
    const RecordRequest request = devo_request(experiment, i);
    all.stress |= request.stress;
    all.peak_force |= request.peak_force;
    all.muscle_work |= request.muscle_work;
    all.tension |= request.tension;
    all.contact |= request.contact;
    all.age |= request.age;
    all.degree |= request.degree;
    all.load |= request.load;
  }
  return all;
}

std::vector<std::string> checked_names(std::vector<std::string> names, const char* function) {
  for (auto name = names.begin(); name != names.end(); ++name) {
    const std::string place = std::string(function) + "() gives the name \"" + printable(*name) + "\"";
    if (name->empty()) throw std::invalid_argument(place + "; expected a name that is not empty");
    if (const std::string fault = text_fault(*name); !fault.empty())
      throw std::invalid_argument(place + ", which " + fault);
    if (std::find(names.begin(), name, *name) != name)
      throw std::invalid_argument(place + " twice; expected different names");
  }
  return names;
}

std::vector<NoteTitle> Experiment::note_titles() const {
  std::vector<NoteTitle> titles = notes;
  titles.insert(titles.end(), child_notes.begin(), child_notes.end());
  return titles;
}

MemoryNames memory_names(const Devo& op) {
  MemoryNames names{checked_names(op.mass_memory(), "mass_memory"), checked_names(op.spring_memory(), "spring_memory"),
                    checked_names(op.body_memory(), "body_memory")};
  for (const std::string& needed : op.traits().needs_at_birth)
    if (std::ranges::find(names.springs, needed) == names.springs.end())
      throw std::invalid_argument("Traits::needs_at_birth names \"" + printable(needed) +
                                  "\", which spring_memory() does not declare");
  return names;
}

std::vector<std::string> spring_memory_names(const Encoding& encoding) {
  return checked_names(encoding.spring_memory(), "spring_memory");
}

MemoryNames memory_names(const Experiment& experiment, std::size_t index) {
  return call_operator(experiment.call_of(Devo::kind, index),
                       [&] { return memory_names(*experiment.devo.at(index).op); });
}

Request fitness_request(const Experiment& experiment, std::size_t index) {
  return call_operator(experiment.call_of(Fitness::kind, index),
                       [&] { return experiment.fitness.at(index).op->observes(); });
}

std::optional<Request> first_objective_request(const Experiment& experiment) {
  for (std::size_t i = 0; i < experiment.fitness.size(); ++i) {
    const auto scores =
        call_operator(experiment.call_of(Fitness::kind, i), [&] { return experiment.fitness[i].op->objectives(); });
    const auto is_objective = [](const Objective& score) { return score.role == Role::objective; };
    if (std::ranges::any_of(scores, is_objective)) return fitness_request(experiment, i);
  }
  return std::nullopt;
}

Recording recording(const RecordRequest& request) {
  return {.stress = request.stress || request.load,
          .peak_force = request.peak_force,
          .muscle_work = request.muscle_work,
          .tension = request.tension};
}

Experiment read_experiment(const ExperimentSource& source) {
  return compose(with_overrides(parse_toml_file(source.file), source), source);
}

Experiment read_experiment(std::string_view text, const ExperimentSource& source) {
  return compose(with_overrides(parse_toml(text, source.file), source), source);
}

bool gives_key(const ExperimentSource& source, std::string_view key) {
  const toml::table root = with_overrides(parse_toml_file(source.file), source);
  return root.at_path(key).node() != nullptr;
}

std::vector<Experiment> read_islands(const ExperimentSource& source) {
  const toml::table root = with_overrides(parse_toml_file(source.file), source);
  Experiment whole = compose(root, source);
  std::vector<Experiment> islands;
  if (whole.islands) {
    for (const toml::table& one : island_roots(root, whole)) {
      Experiment& island = islands.emplace_back(compose(one, source));
      island.island = static_cast<std::int64_t>(islands.size());
      check_same_genomes(islands.front(), island, source);
    }
  } else {
    islands.push_back(std::move(whole));
  }
  return islands;
}

}  // namespace evodevo
