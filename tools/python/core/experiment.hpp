// Experiments in Python: their settings, and the bodies that their encoding makes from genomes.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "archive/archive.hpp"
#include "arrays.hpp"
#include "life/evaluation.hpp"

namespace evodevo::python {

/// Sets the folder of the operators that come with evodevo: lib/evodevo under the prefix to which this module belongs.
void find_operators();

/// An experiment and its operators. module.cpp describes its functions.
class PythonExperiment {
 public:
  /// Reads an experiment from a file, or from the folder of a run.
  explicit PythonExperiment(const std::filesystem::path& path);
  PythonExperiment(const PythonExperiment&) = delete;
  PythonExperiment& operator=(const PythonExperiment&) = delete;
  ~PythonExperiment();

  py::object settings() const;
  std::vector<Genome> random_genomes(std::uint32_t count, std::optional<std::uint64_t> seed) const;
  Genome genome(std::uint32_t individual) const;
  py::list decode(const std::vector<Genome>& genomes) const;

 private:
  /// Whether this process was forked after the experiment was made. A fork does not copy the threads that work on it.
  bool lacks_threads() const { return getpid() != process_; }

  pid_t process_ = getpid();
  std::filesystem::path path_;
  std::optional<Archive> archive_;  ///< of a run
  Experiment experiment_;
  std::unique_ptr<Simulator> simulator_;
  std::unique_ptr<Evaluation> evaluation_;
};

}  // namespace evodevo::python
