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
  const std::string device =
      settings.device.description() + ", " + std::to_string(thread_count(settings.device.threads)) + " host threads";
  const bool are_all = settings.studies.size() == studies.size();
  for (const std::string& name : settings.studies) {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Table> tables = study_named(name).run(settings);
    write_origin(settings.folder, settings.command, device, !are_all);
    for (const Table& table : tables) write(table, settings.folder);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::cerr << "accuracy: " << name << " took " << seconds.count() << " s\n";
  }
}

}  // namespace
}  // namespace evodevo::tools::accuracy

int main(int argc, char** argv) {
  using namespace evodevo::tools;
  return run_program(accuracy::program, argc, argv,
                     [](const CommandLine& line) { accuracy::run(accuracy::parse(line)); });
}
