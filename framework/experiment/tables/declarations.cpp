#include "experiment/tables/declarations.hpp"

#include "operators/host_keys.hpp"

namespace evodevo {

template <>
inline constexpr auto names_of<Method> = method_names;
template <>
inline constexpr std::array<std::string_view, 2> names_of<Precision>{"float", "double"};
template <>
inline constexpr std::array<std::string_view, 2> names_of<Materials>{"table", "computed"};

namespace {

/// What happens to a body for which a fixed dt is too long: it is invalid, or it is simulated all the same.
enum class Unstable { invalid, run };

}  // namespace

template <>
inline constexpr std::array<std::string_view, 2> names_of<Unstable>{"invalid", "run"};

void declare_run(SettingsVisitor& v, Settings& s) {
  v.integer(s.seed, "seed", {0, 0x1p53 - 1}, "Seed of all random numbers.");
  v.integer(s.evaluations, "evaluations", {1, 1e9}, "Evaluations in the whole run.");
  v.real(s.spring_evaluations, "spring_evaluations", {0, 1e18},
         "The run also ends after the generation that reaches this number of spring evaluations; 0: it does not.");
  v.integer(s.population, "population", {1, 1e6}, "Individuals that live on after each generation.");
  v.integer(s.random_individuals, "random_individuals", {0, 1e6}, "Random individuals that enter each generation.");
  v.integer(s.verify, "verify", {0, 1000}, "How many of the best individuals are verified when the run ends.");
  v.require(s.random_individuals <= s.population, "random_individuals",
            "expected at most the population, " + std::to_string(s.population));
}

void declare_mass(SettingsVisitor& v, Settings& s) {
  v.real(s.mass, host_key::mass, {1e-9, 1e9, "kg"}, "Mass of every point mass.");
}

void declare_accuracy(SettingsVisitor& v, Settings& s) {
  choice(v, s.accuracy, "accuracy", "What method, precision, dt and refine are where they are left out.");
}

void declare_simulation(SettingsVisitor& v, Settings& s) {
  choice(v, s.stepping.method, "method", "Time-stepping method.");
  choice(v, s.stepping.precision, "precision", "Arithmetic of the simulation.");
  choice(v, s.stepping.materials, "materials",
         "How a GPU stores the materials of springs: in a table, or as codes, which round them.");
  v.real_or_auto(s.step.dt, "dt", {1e-7, 0.1, "s"},
                 "Time step; auto: each body has a step of its own that is safe for it.");
  v.integer(s.step.refine, "refine", {1, 1000}, "Number by which every time step is divided.");
  auto unstable = s.step.run_unstable ? Unstable::run : Unstable::invalid;
  choice(v, unstable, "unstable",
         "Whether a body for which a fixed dt is too long is invalid, or is simulated all the same.");
  s.step.run_unstable = unstable == Unstable::run;
  choice(v, s.device, "device", "Where to simulate; auto: on a GPU where there is one.");
  v.integer(s.threads, "threads", {0, 4096}, "Threads on the CPU; 0 for all cores.");
}

void declare_development(SettingsVisitor& v, Settings& s) {
  DevelopmentSettings& d = s.development;
  v.integer(d.cycles, "cycles", {0, rng_stream::most_cycles}, "Cycles of simulation and development.");
  v.real(d.cycle_time, "cycle_time", {s.step.dt.value_or(0.001), 1e6, "s"}, "Simulated time of one cycle.");
  v.flag(d.reset, "reset", "Whether the body goes back to its rest positions after every cycle.");
  choice(v, d.control, "control", "Control experiment: what happens in place of development by the operators.");
  choice(v, d.probe, "probe",
         "How the stress of springs is measured: as the exact mean force, or by the paper's tallies.");
  v.integer(d.skip, "skip", {1, 1e9}, "Time steps from one tally to the next; only with skip-shift.");
}

void declare_schedule(SettingsVisitor& v, Schedule& s) {
  constexpr Range cycles{1, rng_stream::most_cycles};
  v.integer(s.from, host_key::from, cycles, "First cycle after which the operator is applied.");
  v.integer(s.to, host_key::to, cycles, "Last cycle after which it may be applied.");
  v.integer(s.every, host_key::every, cycles, "Cycles from one application to the next.");
}

void declare_probability(SettingsVisitor& v, double& probability) {
  v.real(probability, host_key::probability, {0, 1}, "Probability that a child goes through this operator.");
}

void declare(SettingsVisitor& v, Material& material) {
  v.real(material.stiffness, "stiffness", {0, 1e12, "N/m"}, "Spring constant; 0 is air.");
  v.real(material.amplitude, "amplitude", {0, 0.9},
         "Largest change of length by actuation, relative to the rest length.");
  v.real(material.frequency, "frequency", {0, 1e6, "Hz"}, "Frequency of the actuation.");
  v.real(material.phase, "phase", {-100, 100, "rad"}, "Phase of the actuation.");
}

void declare(SettingsVisitor& v, Gravity& gravity) {
  v.real(gravity.acceleration, "acceleration", {0, 1000, "m/s^2"}, "Acceleration by gravity, downwards.");
  v.real(gravity.slope, "slope", {-80, 80, "degrees"}, "Slope of the floor; +x is downhill where it is above 0.");
}

void declare(SettingsVisitor& v, Floor& floor) {
  v.real(floor.stiffness, "stiffness", {0, 1e12, "N/m"},
         "Upward force on a mass for each metre that it is below the floor.");
  v.real(floor.roughness, "roughness", {0, 100, "m"}, "Largest height and depth of rough ground; 0 is level.");
  v.real(floor.wavelength, "wavelength", {1e-3, 1e6, "m"}, "Distance from one hill of rough ground to the next.");
  v.integer(floor.seed, "seed", {0, 0x1p32 - 1}, "Seed of the heights of rough ground.");
}

void declare(SettingsVisitor& v, Friction& friction) {
  v.real(friction.coefficient, "coefficient", {0, 100}, "Coefficient of Coulomb friction.");
}

void declare(SettingsVisitor& v, Damping& damping) {
  v.real(damping.rate, "rate", {0, 1e6, "1/s"}, "Rate of damping: v' = -rate v.");
}

void declare(SettingsVisitor& v, Drag& drag) {
  v.real(drag.coefficient, "coefficient", {0, 1e6, "kg/m"},
         "Coefficient of drag: the force on a mass is -coefficient |v| v.");
}

void declare(SettingsVisitor& v, Payload& payload) {
  v.real(payload.share, "share", {0, 1000, "1"}, "Mass of the payload, relative to the mass of the body at birth.");
  v.real(payload.top, "top", {0, 1, "1"}, "Upper part of the height at birth; the masses in it carry the payload.");
}

}  // namespace evodevo
