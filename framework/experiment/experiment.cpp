#include "experiment/experiment.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <sstream>

#include "analysis/stability.hpp"
#include "base/philox.hpp"
#include "base/text.hpp"
#include "experiment/accuracy.hpp"
#include "experiment/overrides.hpp"
#include "experiment/toml_reader.hpp"
#include "operators/host_keys.hpp"
#include "operators/plugin_folders.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr double unlimited = std::numeric_limits<double>::infinity();
constexpr std::size_t most_materials = 1000;

// ---- what each table of the file holds ----

void declare(Parameters& p, Gravity& gravity) {
  p.real(gravity.acceleration, "acceleration", {0, 1000, "m/s^2"}, "Gravity, downwards.");
  p.real(gravity.slope, "slope", {-80, 80, "degrees"}, "Slope of the floor; +x is downhill where it is above 0.");
}
void declare(Parameters& p, Floor& floor) {
  p.real(floor.stiffness, "stiffness", {0, 1e12, "N/m"}, "Upward force on a mass for each metre below the floor.");
  p.real(floor.roughness, "roughness", {0, 100, "m"}, "Largest height and depth of rough ground; 0 is level.");
  p.real(floor.wavelength, "wavelength", {1e-3, 1e6, "m"}, "From one hill of rough ground to the next.");
  p.integer(floor.seed, "seed", {0, 0x1p32 - 1}, "Seed of rough ground.");
}
void declare(Parameters& p, Friction& friction) {
  p.real(friction.coefficient, "coefficient", {0, 100}, "Coulomb friction between masses and floor.");
}
void declare(Parameters& p, Damping& damping) {
  p.real(damping.rate, "rate", {0, 1e6, "1/s"}, "Uniform damping, v' = -rate v.");
}
void declare(Parameters& p, Drag& drag) {
  p.real(drag.coefficient, "coefficient", {0, 1e6, "kg/m"}, "Drag on each mass, coefficient |v| v.");
}
void declare(Parameters& p, Load& load) {
  p.real(load.share, "share", {0, 1000, "1"}, "Load that a body carries, relative to its mass at birth.");
  p.real(load.top, "top", {0, 1, "1"}, "Upper part of the body's height at birth whose masses carry it.");
}
void declare(Parameters& p, Material& material) {
  p.real(material.stiffness, "stiffness", {0, 1e12, "N/m"}, "Spring constant; 0 is air.");
  p.real(material.amplitude, "amplitude", {0, 0.9}, "Relative change of length.");
  p.real(material.frequency, "frequency", {0, 1e6, "Hz"}, "Frequency of the actuation.");
  p.real(material.phase, "phase", {-100, 100, "rad"}, "Phase of the actuation.");
}
void declare(Parameters& p, Experiment& experiment) {
  p.integer(experiment.seed, "seed", {0, 0x1p53 - 1}, "Seed of all random numbers.");
  p.integer(experiment.evaluations, "evaluations", {1, 1e9}, "Evaluations in the whole run.");
  p.real(experiment.spring_evaluations, "spring_evaluations", {0, 1e18},
         "The run also ends with the generation that reaches as many; 0 for no such end.");
  p.integer(experiment.population, "population", {1, 1e6}, "Individuals that live at once.");
  p.integer(experiment.newcomers, "newcomers", {0, 1e6}, "Random individuals that enter each generation.");
  p.integer(experiment.verify, "verify", {0, 1000}, "Best individuals to verify when the run ends.");
}

/// A place that [plugins] paths names, and why it is not looked at; empty where it is.
struct PluginPlace {
  fs::path path;
  std::string fault;
};

/// In an experiment, whose paths are relative to its folder.
PluginPlace place_in_experiment(const fs::path& named, const ExperimentSource& source) {
  const fs::path path = fs::absolute(source.file).parent_path() / named;
  if (is_plugin_path(path)) return {path, ""};
  return {path, path.lexically_normal().string() + " is no folder and no library of operators"};
}

/// In the record of a run, where they are absolute. Whoever made the record does not decide what code runs here.
PluginPlace place_in_record(const fs::path& named, const ExperimentSource& source) {
  if (!named.is_absolute())
    return {named, named.string() +
                       " is relative, which no run records; if you trust the operators that are meant, name their "
                       "folder with --plugin-path"};
  if (!is_plugin_path(named))
    return {named, named.string() +
                       " is no folder and no library of operators any more; name the one that has taken its place with "
                       "--plugin-path"};
  if (!is_named_by_user(named, source.plugin_path))
    return {named, named.string() +
                       " is named by the record alone; if you trust the operators in it, give --plugin-path " +
                       named.string()};
  return {named, ""};
}

std::vector<PluginPlace> plugin_places(const toml::table& root, const ExperimentSource& source) {
  std::vector<PluginPlace> places;
  if (const toml::array* paths = root["plugins"]["paths"].as_array())
    for (const toml::node& path : *paths)
      if (const auto text = path.value<std::string>())
        places.push_back(source.is_record ? place_in_record(*text, source) : place_in_experiment(*text, source));
  return places;
}

/// Where operators are looked for: in those places, then in those of the command line and of the environment.
std::vector<fs::path> plugin_path(const std::vector<PluginPlace>& places, const ExperimentSource& source) {
  std::vector<fs::path> own;
  for (const PluginPlace& place : places)
    if (place.fault.empty()) own.push_back(place.path);
  for (const fs::path& path : source.plugin_path) own.push_back(fs::absolute(path));
  return plugin_search_path(own);
}

/// Reads the experiment's tables one after the other; each adds its resolved form.
class Composer {
 public:
  Composer(const toml::table& root, const ExperimentSource& source)
      : top_(root, ""),
        source_(source),
        places_(plugin_places(root, source)),
        plugin_path_(plugin_path(places_, source)),
        registry_(plugin_path_) {}

  Experiment compose() {
    top_.expect({"experiment", "encoding", "mutation", "crossover", "scene", "simulation", "development", "fitness",
                 "selection", "materials", "plugins"});
    read_plugins();
    read_section("experiment", true, [&](TomlReader& t) {
      declare(t, out_);
      if (out_.newcomers > out_.population)
        t.fail("newcomers", "expected at most the population, " + std::to_string(out_.population));
    });
    read_materials();
    read_encoding();
    read_scene();
    read_simulation();
    read_variation("mutation", out_.mutations);
    read_variation("crossover", out_.crossovers);
    check_variation();
    read_development();
    read_fitness();
    read_section("selection", true, [&](TomlReader& t) { out_.selection = make<Selection>(t); });
    std::ostringstream text;
    text << top_.finish() << '\n';
    out_.resolved = text.str();
    return std::move(out_);
  }

 private:
  /// Lets `read` take what it knows from [name], then refuses the rest.
  template <class Read>
  void read_section(std::string_view name, bool required, const Read& read) {
    const toml::table* table = top_.table(name);
    if (table == nullptr && required) top_.fail(name, "is missing; add a table [" + std::string(name) + "]");
    if (table == nullptr) return;
    TomlReader reader(*table, std::string(name), &out_.world.material_names);
    read(reader);
    top_.resolve(name, reader.finish());
  }

  /// Calls `read` for each table of the array [[name]] of `parent`.
  template <class Read>
  void read_array(TomlReader& parent, std::string_view name, const Read& read) {
    toml::array resolved;
    const auto tables = parent.tables(name);
    if (tables.size() > place::most_operators)
      parent.fail(name, "expected at most " + std::to_string(place::most_operators) + " of them");
    for (std::size_t i = 0; i < tables.size(); ++i) {
      TomlReader reader(*tables[i], parent.full_name(name) + "." + std::to_string(i), &out_.world.material_names);
      read(reader);
      resolved.push_back(reader.finish());
    }
    if (!tables.empty()) parent.resolve(name, std::move(resolved));
  }

  /// The operator that a table's `name` asks for, with the table's parameters.
  template <class T>
  std::unique_ptr<T> make(TomlReader& table) {
    const std::string name = table.text(host_key::name);
    const AvailableOperator* available = registry_.find(T::kind, name);
    if (available == nullptr) {
      std::string message = "no " + std::string(T::kind) + " operator has this name";
      const std::vector<std::string> known = registry_.names(T::kind);
      message += suggestion(name, known);
      if (nearest(name, known).empty()) message += "; [plugins] paths and --plugin-path name folders with more";
      if (plugin_warnings_ > 0) message += "; " + out_.warnings.front();
      if (plugin_warnings_ > 1) message += " (and " + std::to_string(plugin_warnings_ - 1) + " more such warnings)";
      table.fail("name", message);
    }
    table.require_read_among(host_key::all);
    out_.uses.push_back({available->entry->kind, name, available->manifest->version, available->file,
                         file_hash(available->file), available->title});
    return ask(table, [&] {
      std::unique_ptr<T> op = create<T>(*available);
      op->parameters(table);
      return op;
    });
  }

  /// Runs the own code of the operator that was made last; what it objects to is reported at its name.
  template <class Call>
  auto ask(const TomlReader& table, const Call& call) const {
    try {
      return in_operator({out_.uses.back().title, {}, out_.seed}, call);
    } catch (const ConfigError&) {
      throw;
    } catch (const std::exception& error) {
      table.fail("name", printable(error.what(), 2000));
    }
  }

  void read_plugins() {
    read_section("plugins", false, [&](TomlReader& t) {
      t.texts("paths");
      for (const PluginPlace& place : places_) {
        if (place.fault.empty()) continue;
        if (!source_.is_record) t.fail("paths", place.fault);
        out_.warnings.push_back(place.fault);
      }
    });
    record_plugin_path();
    for (const FailedLibrary& failed : registry_.failed())
      out_.warnings.push_back("not usable: " + printable(failed.file.string()) + ": " + failed.reason);
    plugin_warnings_ = out_.warnings.size();
  }

  /// The record names all folders but the program's own, so that the run can be resumed without the options and the
  /// environment that it was begun with.
  void record_plugin_path() {
    toml::array paths;
    for (const fs::path& path : plugin_path_) {
      if (path == builtin_plugin_folder() || !is_plugin_path(path)) continue;
      out_.plugin_folders.push_back(path.lexically_normal());
      const std::string text = out_.plugin_folders.back().string();
      if (const std::string fault = text_fault(text, PATH_MAX); !fault.empty())
        throw ConfigError(top_.place("plugins") + ": plugins: the path " + fault + "; rename the folder");
      paths.push_back(text);
    }
    if (!paths.empty()) top_.resolve("plugins", toml::table{{"paths", std::move(paths)}});
  }

  void read_materials() {
    auto materials = base_materials();
    toml::table resolved;
    if (const toml::table* table = top_.table("materials")) {
      TomlReader all(*table, "materials");
      if (table->size() > most_materials)
        top_.fail("materials", "expected at most " + std::to_string(most_materials) + " of them");
      for (auto&& [key, node] : *table) {
        const std::string name(key.str());
        if (const std::string fault = text_fault(name); !fault.empty()) all.fail(name, "the name " + fault);
        if (!materials.contains(name)) warn_of_near_material(name);
        TomlReader reader(*all.table(name), "materials." + name);
        declare(reader, materials[name]);
        reader.finish();
      }
      all.finish();
    }
    for (auto& [name, material] : materials) {
      out_.world.material_names.push_back(name);
      out_.world.materials.push_back(material);
      resolved.insert(name, toml::table{{"stiffness", material.stiffness},
                                        {"amplitude", material.amplitude},
                                        {"frequency", material.frequency},
                                        {"phase", material.phase}});
    }
    top_.resolve("materials", std::move(resolved));
  }

  /// A misspelt base material would come into being beside the one that was meant.
  void warn_of_near_material(const std::string& name) {
    std::vector<std::string> known;
    for (const auto& [known_name, material] : base_materials()) known.push_back(known_name);
    if (const std::string near = nearest(name, known); !near.empty())
      out_.warnings.push_back("[materials." + name + "] is a new material beside \"" + near + "\"");
  }

  void read_encoding() {
    out_.world.philox = philox;
    read_section("encoding", true, [&](TomlReader& t) {
      t.real(out_.world.mass, host_key::mass, {1e-9, 1e9, "kg"}, "Mass of every point mass.");
      out_.encoding = make<Encoding>(t);
      out_.layout = ask(t, [&] { return out_.encoding->layout(out_.world); });
    });
  }

  template <class Force>
  void read_force(TomlReader& scene, std::string_view name, std::optional<Force>& force) {
    const toml::table* table = scene.table(name);
    if (table == nullptr) return;
    TomlReader reader(*table, scene.full_name(name));
    declare(reader, force.emplace());
    scene.resolve(name, reader.finish());
  }

  void read_scene() {
    read_section("scene", false, [&](TomlReader& t) {
      t.expect({"gravity", "floor", "friction", "damping", "drag", "load"});
      read_force(t, "gravity", out_.scene.gravity);
      read_force(t, "floor", out_.scene.floor);
      read_force(t, "friction", out_.scene.friction);
      read_force(t, "damping", out_.scene.damping);
      read_force(t, "drag", out_.scene.drag);
      read_force(t, "load", out_.load);
      if (out_.scene.friction && !out_.scene.floor)
        t.fail("friction", "there is nothing to rub on; add [scene.floor] or remove [scene.friction]");
    });
  }

  void read_simulation() {
    const toml::table defaults = parse_toml("", source_.file);
    const toml::table* table = top_.table("simulation");
    TomlReader t(table != nullptr ? *table : defaults, "simulation");
    read_accuracy(t);
    std::string method(name(out_.stepping.method)), unstable = "invalid";
    std::string materials = "table", precision = out_.stepping.precision == Precision::float32 ? "float" : "double";
    t.choice(method, "method",
             {name(Method::paper_euler), name(Method::symplectic_euler), name(Method::velocity_verlet),
              name(Method::rk4), name(Method::implicit), name(Method::xpbd)},
             "Time-stepping method.");
    t.choice(precision, "precision", {"float", "double"}, "Arithmetic of the simulation.");
    t.choice(materials, "materials", {"table", "computed"},
             "How a GPU knows springs' materials; computed: from a code, to which materials are rounded.");
    t.real_or_auto(out_.step.dt, "dt", {1e-7, 0.1, "s"}, "Time step; auto: as long as each body bears.");
    t.integer(out_.step.refine, "refine", {1, 1000}, "What every time step is divided by.");
    t.choice(unstable, "unstable", {"invalid", "run"}, "What a body is, or does, that a fixed dt is too long for.");
    out_.device_place = t.place("device");
    t.choice(out_.device, "device", {"auto", "cpu", "cuda"}, "Where to simulate; auto: on a GPU where there is one.");
    t.integer(out_.threads, "threads", {0, 4096}, "Threads on the CPU; 0 for all cores.");
    out_.stepping.method = method_of(method);
    out_.stepping.precision = precision == "double" ? Precision::float64 : Precision::float32;
    out_.step.run_unstable = unstable == "run";
    if (materials == "computed") compute_materials(t);
    const bool judges_step = source_.grows_bodies && !out_.step.run_unstable;
    if (out_.step.dt && judges_step)
      check_step(t);
    else if (!out_.step.dt && !is_explicit(out_.stepping.method))
      t.fail("dt", "\"" + method + "\" is stable at any step, so none follows from stability; give a number of s");
    top_.resolve("simulation", t.finish());
  }

  void compute_materials(const TomlReader& t) {
    if (out_.stepping.precision != Precision::float32 || !is_explicit(out_.stepping.method))
      t.fail("materials",
             "only explicit methods in single precision compute materials; expected \"table\", or another method, "
             "precision or accuracy");
    out_.stepping.materials = Materials::computed;
  }

  /// What the other keys of [simulation] are where they are left out.
  void read_accuracy(TomlReader& t) {
    std::string accuracy(accuracies.front().name);
    t.choice(accuracy, "accuracy", {accuracies[0].name, accuracies[1].name, accuracies[2].name, accuracies[3].name},
             "Method, precision and dt where they are left out.");
    const auto chosen =
        std::find_if(accuracies.begin(), accuracies.end(), [&](const Accuracy& a) { return a.name == accuracy; });
    out_.stepping = chosen->stepping;
    out_.step = chosen->step;
  }

  /// Refuses a dt that the floor, or a single spring, could not bear, or at which a muscle could not be seen.
  void check_step(const TomlReader& t) const {
    const double mass = out_.world.mass, dt = *out_.step.fixed();
    const auto refuse = [&](const std::string& what, double largest) {
      t.fail("dt", "the step " + to_text(dt) + " s is too long for " + what + "; expected at most " + to_text(largest) +
                       " s");
    };
    const std::string on_masses = " N/m on masses of " + to_text(mass) + " kg";
    const double contact = largest_contact_dt(out_.scene, mass, out_.stepping.method);
    if (dt > contact) refuse("scene.floor.stiffness = " + to_text(out_.scene.floor->stiffness) + on_masses, contact);
    for (std::size_t i = 0; i < out_.world.materials.size(); ++i) {
      const Material& material = out_.world.materials[i];
      const std::string key = "materials." + out_.world.material_names[i];
      const double spring = largest_spring_dt(material, mass, out_.stepping.method),
                   muscle = largest_muscle_dt(material);
      if (dt > spring) refuse(key + ".stiffness = " + to_text(material.stiffness) + on_masses, spring);
      if (dt > muscle) refuse(key + ".frequency = " + to_text(material.frequency) + " Hz", muscle);
    }
  }

  /// Refuses a duration that is not a whole number of steps of a fixed dt.
  void check_duration(const TomlReader& t, std::string_view name, double duration) const {
    if (!out_.step.dt || is_whole_number_of_steps(duration, *out_.step.dt)) return;
    const double dt = *out_.step.dt, steps = std::max(1.0, std::round(duration / dt));
    t.fail(name, to_text(duration) + " s is not a whole number of steps of " + to_text(dt) +
                     " s; the nearest that is: " + to_text(steps * dt) + " s");
  }

  void check_variation() const {
    if (out_.mutations.empty() && out_.crossovers.empty())
      top_.fail("mutation", "is missing; add a table [[mutation]] or [[crossover]]");
    double sum = 0;
    for (const auto& mutation : out_.mutations) sum += mutation.probability;
    for (const auto& crossover : out_.crossovers) sum += crossover.probability;
    if (sum == 0) top_.fail("mutation", "no operator has a probability above 0, so that no child would differ");
  }

  template <class T>
  void read_variation(std::string_view name, std::vector<Varied<T>>& list) {
    read_array(top_, name, [&](TomlReader& t) {
      Varied<T> varied;
      t.real(varied.probability, host_key::probability, {0, 1}, "Probability that a child goes through this operator.");
      varied.op = make<T>(t);
      varied.name = out_.uses.back().name;
      list.push_back(std::move(varied));
    });
  }

  void read_development() {
    Development& development = out_.development;
    read_section("development", false, [&](TomlReader& t) {
      development.cycles = 100;
      t.integer(development.cycles, "cycles", {0, place::most_cycles}, "Cycles of simulation and development.");
      t.real(development.cycle_time, "cycle_time", {out_.step.dt.value_or(0.001), 1e6, "s"},
             "Simulated time of one cycle.");
      t.flag(development.reset, "reset", "Whether the body goes back to its rest places after every cycle.");
      check_duration(t, "cycle_time", development.cycle_time);
      read_control(t);
      read_probe(t);
      read_array(t, "operator", [&](TomlReader& entry) {
        const Schedule schedule = read_schedule(entry);
        development.operators.push_back({make<Devo>(entry), schedule});
        const Devo& op = *development.operators.back().op;
        check_request(entry, ask(entry, [&] { return op.observes(); }));
        if (ask(entry, [&] { return op.uses_growth() && !out_.encoding->sets_growth(); })) warn_of_no_growth(entry);
      });
      if (development.operators.empty()) check_without_operators(t);
    });
  }

  void warn_of_no_growth(const TomlReader& t) {
    out_.warnings.push_back(
        t.full_name("name") + " = \"" + out_.uses.back().name +
        "\": the encoding lets no spring grow, so that nothing changes; set encoding.size_range, or "
        "take an encoding that has it");
  }

  void check_without_operators(const TomlReader& t) {
    const Development& development = out_.development;
    const std::string remedy = "no operator develops anything; add a table [[development.operator]]";
    if (development.control != Control::off) t.fail("control", remedy + ", or set control = \"off\"");
    if (development.cycles > 0)
      out_.warnings.push_back("development.cycles = " + std::to_string(development.cycles) + ": " + remedy +
                              ", or leave [development] out");
  }

  void read_probe(TomlReader& t) {
    Development& development = out_.development;
    std::string probe = "exact";
    t.choice(probe, "probe", {"exact", "skip-shift"},
             "How the springs' stress is known: as exact means, or by the paper's tallies.");
    if (probe == "skip-shift") development.probe = Probe::skip_shift;
    t.integer(development.skip, "skip", {1, 1e9}, "Steps from one tally of skip-shift to the next.");
    if (development.probe != Probe::skip_shift || !out_.step.fixed()) return;
    const double steps = std::round(development.cycle_time / *out_.step.fixed());
    if (static_cast<double>(development.skip) > steps)
      t.fail("skip", "a cycle of " + to_text(steps) + " steps has no tally; expected at most as many");
  }

  /// Refuses what tallies do not tell.
  void check_request(const TomlReader& t, const SpringRequest& request) const {
    if (out_.development.probe == Probe::skip_shift && (request.peak_force || request.muscle_work || request.tension))
      t.fail("name",
             "this operator asks for more of the springs than the tallies of development.probe = \"skip-shift\" "
             "tell; set development.probe = \"exact\", or let it go by the mean force");
  }

  /// Refuses windows that no body can live through.
  static void check_request(const TomlReader& t, const Request& request) {
    constexpr double longest = 1e6;  // s, as of a cycle
    const auto text = [](double time) { return std::isfinite(time) ? to_text(time) + " s" : "no finite number"; };
    // written so that NaN fails
    if (!(request.settle >= 0 && request.settle <= longest) || !(request.window > 0 && request.window <= longest))
      t.fail("name", "this operator observes settle = " + text(request.settle) +
                         " and window = " + text(request.window) + "; expected 0 to " + text(longest) +
                         ", and above 0 to " + text(longest));
  }

  void read_control(TomlReader& t) {
    std::string control = "off";
    t.choice(control, "control", {"off", "no-change", "random-places", "shuffled-stress"},
             "What the experiment's control does to development.");
    const auto found = std::find(control_names.begin(), control_names.end(), control);
    out_.development.control = static_cast<Control>(found - control_names.begin());
  }

  /// When a devo operator comes to its turn; by default after every cycle.
  Schedule read_schedule(TomlReader& t) {
    const std::int64_t cycles = out_.development.cycles;
    Schedule schedule;
    schedule.to = std::max<std::int64_t>(1, cycles);
    t.integer(schedule.from, host_key::from, {1, place::most_cycles}, "First cycle after which the operator comes.");
    t.integer(schedule.to, host_key::to, {1, place::most_cycles}, "Last cycle after which it may come.");
    t.integer(schedule.every, host_key::every, {1, place::most_cycles}, "Cycles from one turn to the next.");
    if (schedule.turns(cycles) == 0 && cycles > 0)
      out_.warnings.push_back(t.full_name("from") + " = " + std::to_string(schedule.from) + " to " +
                              std::to_string(schedule.to) + ": the operator never comes to its turn in " +
                              std::to_string(cycles) + " cycles");
    return schedule;
  }

  void read_fitness() {
    read_array(top_, "fitness", [&](TomlReader& t) {
      std::unique_ptr<Fitness> fitness = make<Fitness>(t);
      const Request request = ask(t, [&] { return fitness->observes(); });
      check_request(t, request);
      check_duration(t, "settle", request.settle);
      check_duration(t, "window", request.window);
      std::vector<Objective> objectives = ask(t, [&] { return fitness->objectives(); });
      if (objectives.empty()) t.fail("name", "this operator has no objectives; expected one or more from objectives()");
      for (Objective& objective : objectives) {
        if (objective.name.empty())
          t.fail("name", "this operator has an objective without a name; name it in objectives()");
        const auto same = [&](const Objective& other) { return other.name == objective.name; };
        for (const std::string& text : {objective.name, objective.unit})
          if (const std::string fault = text_fault(text); !fault.empty())
            t.fail("name", "its objective's name or unit " + fault);
        if (std::any_of(out_.objectives.begin(), out_.objectives.end(), same))
          t.fail("name", "there is an objective \"" + objective.name + "\" already");
        out_.objectives.push_back(std::move(objective));
      }
      out_.fitness.push_back(std::move(fitness));
    });
    if (out_.fitness.empty()) top_.fail("fitness", "is missing; add a table [[fitness]]");
  }

  TomlReader top_;
  const ExperimentSource& source_;
  std::vector<PluginPlace> places_;
  std::vector<fs::path> plugin_path_;
  Registry registry_;
  Experiment out_;
  std::size_t plugin_warnings_ = 0;  ///< which come first
};

// ---- from file to experiment ----

Experiment compose(toml::table root, const ExperimentSource& source) {
  for (const Override& change : source.overrides) apply_override(change, root);
  Experiment experiment = Composer(root, source).compose();
  experiment.name = printable(fs::path(source.file).stem().string());
  return experiment;
}

}  // namespace

Experiment read_experiment(const ExperimentSource& source) { return compose(parse_toml_file(source.file), source); }

Experiment read_experiment(std::string_view text, const ExperimentSource& source) {
  return compose(parse_toml(text, source.file), source);
}

std::map<std::string, Material> base_materials() {
  constexpr double pi = 3.14159265358979323846;
  return {{"muscle", {5000, 0.14, 1, 0}},
          {"tissue", {4000, 0, 0, 0}},
          {"muscle2", {5000, 0.14, 1, pi}},
          {"bone", {10000, 0, 0, 0}},
          {"air", {0, 0, 0, 0}}};
}

}  // namespace evodevo
