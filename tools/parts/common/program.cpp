#include "common/program.hpp"

#include <algorithm>
#include <iostream>
#include <stdexcept>

#include "base/output_file.hpp"
#include "base/standard_streams.hpp"

namespace evodevo::tools {
namespace {

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

int run_program(const Program& program, int argc, const char* const* argv,
                const std::function<void(const CommandLine&)>& run) {
  open_standard_streams();
  try {
    const CommandLine line(argv + 1, argv + argc);
    if (contains(line, "--help"))
      std::cout << program.help;
    else
      run(line);
    finish_standard_output();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << program.name << ": " << error.what() << '\n';
    return 2;
  }
}

boost::program_options::variables_map read_options(
    const CommandLine& line, const boost::program_options::options_description& options,
    const boost::program_options::positional_options_description& positional) {
  namespace po = boost::program_options;
  po::variables_map values;
  po::store(po::command_line_parser(line).options(options).positional(positional).run(), values);
  po::notify(values);
  return values;
}

std::string command_of(const Program& program, const CommandLine& line, const std::vector<std::string>& omitted) {
  std::string command = "tools/" + std::string(program.name);
  for (const std::string& word : line)
    if (!contains(omitted, word)) command += ' ' + word;
  return command;
}

void require_folder(const Program& program, const CommandLine& line) {
  if (!line.empty() && !line.front().empty() && line.front().front() != '-' && !line.front().ends_with(".toml")) return;
  throw std::invalid_argument("name the folder for data and charts first, as in tools/" + std::string(program.name) +
                              " charts --quick");
}

void check_choice(const std::string& option, const std::string& value, const std::vector<std::string>& known) {
  if (contains(known, value)) return;
  std::string names;
  for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
  throw std::invalid_argument("--" + option + " \"" + value + "\": expected one of " + names);
}

void check_device(const std::string& device) {
  check_choice("device", device, {"cpu", "cuda"});
#ifndef EVODEVO_CUDA
  if (device == "cuda")
    throw std::invalid_argument("this program was built without CUDA; configure with -DEVODEVO_CUDA=ON");
#endif
}

void write_origin(const std::filesystem::path& folder, const std::string& command, const std::string& device) {
  write_file(folder / "origin.txt", command + '\n' + device + '\n');
}

}  // namespace evodevo::tools
