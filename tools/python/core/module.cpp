// The module evodevo.core. evodevo/core.pyi declares it for editors and type checkers.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "base/input_error.hpp"
#include "core/simulator.hpp"
#include "experiment.hpp"
#include "simulation.hpp"

namespace evodevo::python {
namespace {

using py::literals::operator""_a;

void translate(std::exception_ptr error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const InputError& bad_input) {
    PyErr_SetString(PyExc_ValueError, bad_input.what());
  } catch (const DeviceOutOfMemory& full) {
    PyErr_SetString(PyExc_MemoryError, full.what());
  }
}

Genome genome_of(py::handle genes) {
  const Numbers numbers = numbers_in(genes, "genes", {any_size});
  Genome genome;
  for (py::ssize_t i = 0; i < numbers.size(); ++i) genome.genes.push_back(static_cast<float>(numbers.data()[i]));
  return genome;
}

void set_genes(Genome& genome, py::handle genes) {
  const auto count = static_cast<py::ssize_t>(genome.size());
  numbers_in(genes, "genes", {count});
  genome.genes = genome_of(genes).genes;
}

void define_genome(py::module_& module) {
  py::class_<Genome>(module, "Genome",
                     "The genes of one individual, and the blocks into which they are grouped. `Genome(genes)` makes "
                     "one where all genomes have the same blocks; otherwise, take one from an Experiment and change "
                     "its genes.")
      .def(py::init(&genome_of), "genes"_a, "`genes` is an array [genes].")
      .def_property(
          "genes", [](const Genome& genome) { return array_of(genome.genes); }, &set_genes,
          "[genes] numpy.float32, a copy; assign an array of the same size to change them.");
}

void define_experiment(py::module_& module) {
  py::class_<PythonExperiment>(module, "Experiment",
                               "An experiment with its operators, which are found as the program `evodevo` finds them.")
      .def(py::init<std::filesystem::path>(), "path"_a,
           "Reads the TOML file of an experiment, or the experiment of a run from the folder of the run. Raises "
           "ValueError with the place, the value and a remedy.")
      .def_property_readonly("settings", &PythonExperiment::settings,
                             "The tables of the experiment with every default, as dictionaries.")
      .def(
          "random_genomes", &PythonExperiment::random_genomes, "count"_a, "seed"_a = py::none(),
          "Returns `count` genomes of random individuals. They depend on `seed` alone, which by default is that of the "
          "experiment; then they are those with which its runs begin, except that runs replace equal genomes.")
      .def("genome", &PythonExperiment::genome, "individual"_a,
           "Returns the genome of an individual of the run. Raises ValueError if there is none.")
      .def("decode", &PythonExperiment::decode, "genomes"_a,
           "Returns an evodevo.Body for each genome: the body that the encoding makes of it, not born yet, or None if "
           "it makes no body, for example because all of it is air. Other Python threads run in the meantime. Raises "
           "ValueError if a genome is not one of the experiment.");
}

void define_result(py::module_& module) {
  using Result = SimulationResult;
  py::class_<Result>(module, "SimulationResult",
                     "What a body did. n is the number of its masses, m that of its springs, t that of the samples. "
                     "Arrays have new memory.")
      .def_readonly("status", &Result::status,
                    "\"ok\"; \"invalid\" if the body cannot be simulated in this scene or with this time step; or "
                    "\"diverged\".")
      .def_readonly("reason", &Result::reason, "The reason for another status than \"ok\".")
      .def_readonly("ended_at", &Result::ended_at, "The time since birth at which the body diverged, s.")
      .def_readonly("time", &Result::time, "The time since birth at the end, s.")
      .def_readonly("dt", &Result::dt, "The time step, s; 0 if the body is invalid.")
      .def_readonly("positions", &Result::positions, "[n, 3] at the end, m.")
      .def_readonly("velocities", &Result::velocities, "[n, 3] at the end, m/s.")
      .def_readonly("masses", &Result::masses, "[n] including the payload of the scene, kg.")
      .def_readonly("records", &Result::records,
                    "For each name in `record` an array [m], over the whole simulation; empty unless the status is "
                    "\"ok\".")
      .def_readonly("sample_times", &Result::sample_times, "[t] since birth, s.")
      .def_readonly("samples", &Result::samples,
                    "For each name in `sampled` an array, if `sample_hz` is above 0: \"centre\" [t, 3] m, "
                    "\"positions\" [t, n, 3] m, \"velocities\" [t, n, 3] m/s, \"forces\" [t, m] N, positive if the "
                    "spring pulls. All but the centre of mass are numpy.float32. t is 0 unless the status is \"ok\".")
      .def("__repr__", [](const Result& result) {
        return "<evodevo.core.SimulationResult: " + result.status + (result.reason.empty() ? "" : ", ") +
               result.reason + ">";
      });
}

}  // namespace

PYBIND11_MODULE(core, module) {
  module.doc() = "Simulates bodies in batches, and makes bodies from genomes, with the code of the program `evodevo`.";
  find_operators();
  py::register_exception_translator(&translate);
  define_genome(module);
  define_experiment(module);
  define_result(module);
  module.def("simulate", &simulate, "bodies"_a, "seconds"_a, py::kw_only(), "scene"_a = py::dict(),
             "simulation"_a = py::dict(), "cycle_time"_a = 1.0, "record"_a = std::vector<std::string>{},
             "sample_hz"_a = 0.0, "sampled"_a = std::vector<std::string>{"centre", "positions"},
             R"(Simulates bodies in one batch, and returns a SimulationResult for each.

bodies      a sequence of evodevo.Body. Results do not depend on what else is in the batch.
seconds     the simulated time, s; rounded to the nearest time step
scene       the table [scene] of an experiment as a dictionary; a force that it does not have is not computed:
            {"gravity": {}, "floor": {"stiffness": 1e5}}
simulation  the table [simulation], which has the method, the precision, dt, the device and the number of threads
cycle_time  the key of that name in the table [development], s: a whole number of the steps of each body if dt is "auto"
record      names of quantities of springs: "stress" (mean absolute force, N), "peak_force" (largest absolute force, N),
            "tension" (mean force, N, positive if the spring pulled), "muscle_work" (energy that it gave the body, J)
sample_hz   the number of samples for each second, Hz; 0 for none. The first is at the beginning, and each is at the
            nearest time step.
sampled     names of quantities of samples: "centre", "positions", "velocities", "forces"

The motion is bit-identical to that of `evodevo simulate` with the same build, device, body and settings. Other Python
threads run in the meantime, and Ctrl-C ends it only when all bodies are done. Raises ValueError with the place, the
value and a remedy if an argument cannot be used, MemoryError if a GPU has too little memory for one body, and
RuntimeError if the device fails.)");
}

}  // namespace evodevo::python
