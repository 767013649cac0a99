#include "experiment.hpp"

#include <dlfcn.h>

#include <limits>

#include "archive/record_check.hpp"
#include "base/genome_sections.hpp"
#include "base/philox.hpp"
#include "base/text.hpp"
#include "bodies.hpp"
#include "evolution/breeding.hpp"
#include "evolution/resimulation.hpp"
#include "experiment/device.hpp"
#include "operators/loader.hpp"

namespace evodevo::python {

namespace fs = std::filesystem;

namespace {

void warn(const Experiment& experiment) {
  for (const std::string& warning : experiment.warnings)
    if (PyErr_WarnEx(PyExc_UserWarning, printable(warning, InputError::longest_message).c_str(), 1) != 0)
      throw py::error_already_set();
}

}  // namespace

void find_operators() {
  Dl_info module = {};
  if (dladdr(reinterpret_cast<const void*>(&find_operators), &module) == 0) return;
  // PREFIX/lib/python3.11/site-packages/evodevo/core.so
  fs::path prefix = fs::canonical(module.dli_fname);
  for (int i = 0; i < 5; ++i) prefix = prefix.parent_path();
  set_builtin_plugin_folder(prefix / "lib/evodevo");
}

PythonExperiment::PythonExperiment(const fs::path& path) : path_(path) {
  {
    const py::gil_scoped_release others_may_run_python;
    if (fs::is_directory(path)) {
      archive_.emplace(Archive::read(path));
      experiment_ = experiment_for_resimulation(*archive_, {});
    } else {
      experiment_ = read_experiment({path.string(), {}});
    }
    simulator_ = make_simulator(experiment_);
    evaluation_ = std::make_unique<Evaluation>(experiment_, *simulator_);
  }
  warn(experiment_);
}

PythonExperiment::~PythonExperiment() {
  if (!lacks_threads()) return;
  // waiting for threads that are not there would never end
  static_cast<void>(evaluation_.release());
  static_cast<void>(simulator_.release());
}

py::object PythonExperiment::settings() const {
  return py::module_::import("tomllib").attr("loads")(experiment_.resolved);
}

std::vector<Genome> PythonExperiment::random_genomes(std::uint32_t count, std::optional<std::uint64_t> seed) const {
  const auto first_seed = seed.value_or(static_cast<std::uint64_t>(experiment_.seed));
  std::vector<Genome> genomes;
  for (std::uint32_t i = 0; i < count; ++i)
    genomes.push_back(first_genome(experiment_,
                                   [&](std::uint32_t section) {
                                     return Rng(philox, {first_seed, 0, i, rng_stream::section(section)});
                                   },
                                   {.individual = i}));
  return genomes;
}

Genome PythonExperiment::genome(std::uint32_t individual) const {
  if (!archive_)
    throw ConfigError(path_.string() +
                      ": is the file of an experiment, which has no individuals; give the folder of a "
                      "run");
  const auto found = archive_->individual(individual);
  if (!found) throw ConfigError(path_.string() + ": has no individual " + std::to_string(individual));
  check_genes(*archive_, experiment_, *found);
  return found->genome;
}

py::list PythonExperiment::decode(const std::vector<Genome>& genomes) const {
  if (lacks_threads())
    throw ConfigError(path_.string() +
                      ": the Experiment was made before this process was forked, which copies none of its threads; "
                      "make another one in this process");
  std::vector<Newborn> newborns;
  for (std::size_t i = 0; i < genomes.size(); ++i) {
    if (const std::string fault = genome_fault(genomes[i], experiment_.layout); !fault.empty())
      throw ConfigError("genomes[" + std::to_string(i) + "]: has " + fault +
                        "; give a genome of random_genomes() or genome(), or change its genes within their bounds");
    newborns.push_back({static_cast<std::uint32_t>(i), 0, &genomes[i]});
  }
  std::vector<BuiltBody> built;
  {
    const py::gil_scoped_release others_may_run_python;
    built = evaluation_->birth.build(newborns);
  }
  py::list bodies;
  for (const BuiltBody& one : built)
    bodies.append(one.failure.empty() ? body_to_python(one, experiment_.context.material_names)
                                      : py::object(py::none()));
  return bodies;
}

}  // namespace evodevo::python
