// Writes the tables of the studies that are asked for.
#include <chrono>
#include <iostream>
#include <stdexcept>

#include "base/output_file.hpp"
#include "base/standard_streams.hpp"
#include "studies.hpp"
#include "threads/parallel.hpp"

namespace evodevo::accuracy {
namespace {

const Study& study_named(const std::string& name) {
  for (const Study& study : studies)
    if (study.name == name) return study;
  throw std::logic_error("no study " + name);
}

/// What made the tables, so that anyone can repeat it.
void write_origin(const Settings& settings) {
  write_file(settings.folder / "origin.txt", settings.command + '\n' + settings.device.description() + ", " +
                                                 std::to_string(thread_count(settings.device.threads)) +
                                                 " host threads\n");
}

void run(const Settings& settings) {
  std::filesystem::create_directories(settings.folder);
  for (const std::string& name : settings.studies) {
    const auto start = std::chrono::steady_clock::now();
    for (const Table& table : study_named(name).run(settings)) write(table, settings.folder);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::cerr << "accuracy: " << name << " took " << seconds.count() << " s\n";
  }
  write_origin(settings);
}

}  // namespace
}  // namespace evodevo::accuracy

int main(int argc, char** argv) {
  evodevo::open_standard_streams();
  try {
    if (const auto settings = evodevo::accuracy::parse(argc, argv)) evodevo::accuracy::run(*settings);
    evodevo::finish_standard_output();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "accuracy: " << error.what() << '\n';
    return 2;
  }
}
