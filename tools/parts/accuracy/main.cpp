// Runs the studies named on the command line, and writes their tables.
#include <chrono>
#include <iostream>
#include <stdexcept>

#include "studies.hpp"
#include "threads/parallel.hpp"

namespace evodevo::tools::accuracy {
namespace {

const Study& study_named(const std::string& name) {
  for (const Study& study : studies)
    if (study.name == name) return study;
  throw std::logic_error("no study " + name);
}

void run(const Settings& settings) {
  std::filesystem::create_directories(settings.folder);
  for (const std::string& name : settings.studies) {
    const auto start = std::chrono::steady_clock::now();
    for (const Table& table : study_named(name).run(settings)) write(table, settings.folder);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::cerr << "accuracy: " << name << " took " << seconds.count() << " s\n";
  }
  write_origin(
      settings.folder, settings.command,
      settings.device.description() + ", " + std::to_string(thread_count(settings.device.threads)) + " host threads");
}

}  // namespace
}  // namespace evodevo::tools::accuracy

int main(int argc, char** argv) {
  using namespace evodevo::tools;
  return run_program(accuracy::program, argc, argv,
                     [](const CommandLine& line) { accuracy::run(accuracy::parse(line)); });
}
