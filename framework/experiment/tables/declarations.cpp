#include "experiment/tables/declarations.hpp"

#include "base/text.hpp"
#include "experiment/time_steps.hpp"
#include "operators/host_keys.hpp"

namespace evodevo {

template <>
inline constexpr auto names_of<Method> = method_names;
template <>
inline constexpr std::array<std::string_view, 2> names_of<Precision>{"float", "double"};
template <>
inline constexpr std::array<std::string_view, 2> names_of<Materials>{"table", "computed"};

namespace {

/// What happens to a body for which a fixed dt is too long: it is invalid, or it is simulated anyway.
enum class Unstable { invalid, run };

}  // namespace

template <>
inline constexpr std::array<std::string_view, 2> names_of<Unstable>{"invalid", "run"};

void declare_run(Parameters& v, Settings& s) {
  v.integer(s.seed, "seed", {0, 0x1p53 - 1}, "Seed of all random numbers.");
  v.integer(s.evaluations, "evaluations", {1, 1e9}, "Number of evaluations in the whole run.");
  v.real(s.spring_evaluations, "spring_evaluations", {0, 1e18},
         "The run also ends after the generation that reaches this number of spring evaluations; 0: no such limit.");
  v.real(
      s.hours, "hours", {0, 1e6, "h"},
      "The run also ends after the generation that completes this time of evolution, by the clock; 0: no such limit.");
  v.integer(s.population, "population", {1, 1e6}, "Number of individuals that survive each generation.");
  v.integer(s.children, "children", {0, 1e6},
            "Number of individuals that are born in each generation; 0: as many as the population. In the first "
            "generation, at "
            "least as many as the population are born, unless the selection operator makes the children itself.");
  v.integer(s.random_individuals, "random_individuals", {0, 1e6},
            "Number of random individuals among those that are born in each generation; by default 0 if only "
            "one is born or the selection operator makes the children itself.");
  v.integer(s.lives, "lives", {1, 1000},
            "Number of lives of each individual: birth, development and measurement in all scenarios and repeats, each "
            "life with its own noise and damage.");
  v.real(s.birth_noise, "birth_noise", {0, 0.5, "1"},
         "Largest offset by which each mass of a newborn is moved along each axis at random, relative to the body's "
         "longest side; other offsets in each life.");
  v.integer(s.verify, "verify", {0, 1000}, "Number of best individuals that are verified when the run ends.");
  choice(v, s.verify_front, "verify_front",
         "How individuals are verified before they enter the front, where those that do not hold lose their fitness: "
         "trials, by the trials that find artefacts and passive robots; lives, also by new lives.");
  v.text(
      s.start, "start",
      "Folder of a run, relative to this file: its last population is born again in the first generation of this run; "
      "empty: all individuals of the first generation are random.");
  v.require(s.random_individuals <= s.newborns(), "random_individuals",
            std::string("expected at most the ") + (s.children > 0 ? "children" : "population") + ", " +
                std::to_string(s.newborns()));
}

void declare_mass(Parameters& v, Settings& s) {
  v.real(s.mass, host_key::mass, {1e-9, 1e9, "kg"}, "Mass of each point mass of a body, without payload.");
}

void declare_accuracy(Parameters& v, Settings& s) {
  choice(v, s.accuracy, "accuracy",
         "Preset for method, precision, dt and refine: sets those of them that are left out.");
}

void declare_simulation(Parameters& v, Settings& s) {
  choice(v, s.stepping.method, "method", "Time-stepping method.");
  choice(v, s.stepping.precision, "precision", "Floating-point precision of the simulation.");
  choice(v, s.stepping.materials, "materials",
         "How a GPU stores the materials of springs: exactly in a table, or rounded in codes from which it computes "
         "them.");
  v.declare({"dt", "Time step; auto: each body has its own time step, at which its simulation is stable.",
             parameter::OptionalReal{s.step.dt, {1e-7, 0.1, "s"}, "auto"}});
  v.integer(s.step.refine, "refine", {1, 1000}, "Number by which every time step is divided.");
  auto unstable = s.step.run_unstable ? Unstable::run : Unstable::invalid;
  choice(v, unstable, "unstable",
         "What happens to a body for which a fixed dt is too long: it is invalid, or it is simulated nevertheless.");
  s.step.run_unstable = unstable == Unstable::run;
  choice(v, s.device, "device", "Where to simulate; auto: on a GPU if there is one.");
  v.integer(s.threads, "threads", {0, 4096}, "Number of threads on the CPU; 0: one for each core.");
}

void declare_development(Parameters& v, Settings& s) {
  DevelopmentSettings& d = s.development;
  v.integer(d.cycles, "cycles", {0, rng_stream::most_cycles},
            "Number of cycles of simulation and development; by default 0 if there is no devo operator.");
  v.real(d.cycle_time, "cycle_time", {s.step.dt.value_or(shortest_cycle), 1e6, "s"}, "Simulated time of one cycle.");
  v.flag(d.reset, "reset", "Whether the body returns to its rest positions after every cycle.");
  choice(v, d.draws, "draws",
         "Random numbers of development, noise and damage: inherited, the same in all individuals for masses of the "
         "same identity; or individual, others in each individual.");
  choice(v, d.draws_between_lives, "draws_between_lives",
         "Whether the random numbers of development are the same in all lives of an individual, or new in each.");
  v.integer(d.seed, "seed", {0, 0x1p53 - 1},
            "Seed of inherited draws, one for all islands; by default the run's or, with experiment.start, that of the "
            "run with whose last population this one begins.");
  choice(v, d.control, "control", "Control experiment: what replaces development by the operators; off: nothing does.");
  choice(v, d.probe, "probe",
         "How the stress of springs is measured: exactly, as the mean absolute force, or by the paper's tallies.");
  v.integer(d.skip, "skip", {1, 1e9},
            "Number of time steps from one tally to the next; used only with probe = \"skip-shift\".");
}

void declare_scenario(Parameters& v, Scenario& s) {
  v.real(s.start_noise, "start_noise", {0, 0.5, "1"},
         "Largest offset by which each mass is moved along each axis at random, relative to the body's longest side.");
  v.flag(s.muscles, "muscles", "Whether the muscles are actuated.");
  v.real(s.damage, "damage", {0, 0.99, "1"},
         "Share of the springs that the robot loses around a random place, with the pieces that this tears off.");
  v.integer(s.repeat, "repeat", {1, 1000}, "Number of repeats, each with its own noise and damage.");
  v.flag(s.develops, "develops",
         "Whether the robot is born and matures in this scene, with this payload; otherwise it has matured in the "
         "scene of the experiment. Noise, damage and still muscles begin when it has matured.");
}

void declare_over(Parameters& v, std::string& over) {
  v.text(
      over, host_key::over,
      "How the scores in several tests become one: \"mean\", \"worst\" or \"median\" of all scenarios and repeats, or "
      "the name of a scenario: the mean of its repeats.");
}

void declare_over_lives(Parameters& v, Over& over) {
  choice(v, over, host_key::over_lives,
         "How the scores of its objectives in several lives become one. Descriptors and measures: always their mean; "
         "constraints: their worst.");
}

void declare_schedule(Parameters& v, Schedule& s) {
  constexpr Range cycles{1, rng_stream::most_cycles};
  v.integer(s.from, host_key::from, cycles, "First cycle after which the operator is applied.");
  v.integer(s.to, host_key::to, cycles, "Last cycle after which the operator may be applied.");
  v.integer(s.every, host_key::every, cycles, "Number of cycles from one application of the operator to the next.");
}

void declare_remeasure(Parameters& v, Settings& s) {
  v.integer(s.remeasure, host_key::remeasure, {0, 1e6},
            "Number of members of the population that live again in each generation, those first that were measured "
            "longest ago; their scores become those of all their lives. For operators that keep elders.");
}

void declare_probability(Parameters& v, double& probability) {
  v.real(probability, host_key::probability, {0, 1}, "Probability that this operator is applied to a child.");
}

void declare(Parameters& v, Material& material) {
  v.real(material.stiffness, "stiffness", {0, 1e12, "N/m"},
         "Spring constant; 0: the material is air, and its springs are left out.");
  v.real(material.amplitude, "amplitude", {0, largest_amplitude},
         "Amplitude of the actuation: largest change of length, relative to the rest length.");
  v.real(material.frequency, "frequency", {0, 1e6, "Hz"}, "Frequency of the actuation.");
  v.real(material.phase, "phase", {-100, 100, "rad"}, "Phase of the actuation.");
  v.real(
      material.damping, "damping", {0, 10, "1"},
      "Damping ratio of the dashpot beside each spring: 1 is the critical damping of its two masses; 0: no dashpot.");
}

void declare(Parameters& v, Gravity& gravity) {
  v.real(gravity.acceleration, "acceleration", {0, 1000, "m/s^2"}, "Acceleration by gravity, downwards.");
  v.real(gravity.slope, "slope", {-80, 80, "degrees"}, "Slope of the floor; if it is above 0, +x points downhill.");
}

void declare(Parameters& v, Floor& floor) {
  v.optional_real(floor.restitution, "restitution", {0, 1},
                  "Makes the floor rigid: the speed with which a mass bounces off, relative to the speed with which it "
                  "arrives. Give this key or stiffness.");
  if (!floor.restitution)
    v.real(floor.stiffness, "stiffness", {0, 1e12, "N/m"},
           "Upward force of an elastic floor on a mass, per metre of its depth below the floor.");
  v.real(floor.roughness, "roughness", {0, 100, "m"},
         "Largest height, and largest depth, of rough ground; 0: the ground is level.");
  v.real(floor.wavelength, "wavelength", {1e-3, 1e6, "m"}, "Distance from one hill of rough ground to the next.");
  v.integer(floor.seed, "seed", {0, 0x1p32 - 1}, "Seed of the heights of rough ground.");
}

void declare(Parameters& v, Friction& friction) {
  v.real(friction.coefficient, "coefficient", {0, 100}, "Coefficient of Coulomb friction.");
  v.optional_real(
      friction.static_coefficient, "static", {0, 100},
      "Coefficient of static friction, which holds a mass at rest; at least coefficient, by default the same.");
  v.require(friction.holding() >= friction.coefficient, "static",
            "expected at least the coefficient, " + to_text(friction.coefficient));
}

void declare(Parameters& v, Damping& damping) {
  v.real(damping.rate, "rate", {0, 1e6, "1/s"}, "Rate at which every velocity decays: dv/dt = -rate v.");
}

void declare(Parameters& v, Drag& drag) {
  v.real(drag.coefficient, "coefficient", {0, 1e6, "kg/m"},
         "Coefficient of drag: the force on a mass is -coefficient |v| v.");
}

void declare(Parameters& v, Payload& payload) {
  v.real(payload.share, "share", {0, 1000, "1"}, "Mass of the payload, relative to the mass of the body at birth.");
  v.real(payload.top, "top", {0, 1, "1"},
         "Fraction of the body's height at birth, from the top down, in which the masses carry the payload.");
}

void declare(Parameters& v, IslandSettings& s) {
  v.integer(s.count, "count", {2, most_islands}, "Number of islands.");
  choice(v, s.topology, "topology",
         "Which islands send migrants to which: each to the next (ring), to its four neighbours on a grid that is "
         "closed like a torus, to all others (full), or the first to all others and these to it (star).");
  v.integer(s.every, "every", {1, 1e9}, "Number of generations from one migration to the next.");
  v.integer(s.migrants, "migrants", {1, 1e6}, "Number of individuals that an island sends to each of its neighbours.");
  choice(v, s.emigrants, "emigrants",
         "Who emigrates: those with the best first objective, or individuals with a fitness, drawn at random.");
  choice(v, s.replaced, "replaced",
         "Whose place an immigrant takes if selection would drop it in the generation of its arrival: that of the "
         "survivor with the worst first objective, or of a random one; nobody: it is dropped.");
}

void declare_island_number(Parameters& v, std::int64_t& number) {
  v.integer(number, "number", {1, most_islands}, "Number of the island, from 1.");
}

void declare_island(Parameters& v, std::optional<double>& seed) {
  v.optional_real(seed, "seed", {0, 0x1p53 - 1},
                  "Seed of all random numbers of the island; by default it follows from the seed of the run.");
}

}  // namespace evodevo
