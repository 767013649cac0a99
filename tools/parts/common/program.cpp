#include "common/program.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iostream>
#include <iterator>
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
  const po::parsed_options parsed = po::command_line_parser(line).options(options).positional(positional).run();
  for (const po::option& option : parsed.options)  // Boost turns negative numbers into large ones
    for (const std::string& value : option.value)
      if (value.size() > 1 && value[0] == '-' && std::isdigit(static_cast<unsigned char>(value[1])))
        throw std::invalid_argument("--" + option.string_key + ' ' + value + ": expected a number of at least 0");
  po::store(parsed, values);
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

void write_origin(const std::filesystem::path& folder, const std::string& command, const std::string& device,
                  bool keeps) {
  const std::filesystem::path file = folder / "origin.txt";
  const std::string origin = command + '\n' + device + '\n';
  std::string others;
  if (std::ifstream stream(file); keeps && stream) others.assign(std::istreambuf_iterator<char>(stream), {});
  if (const std::size_t at = others.find(origin); at != std::string::npos) others.erase(at, origin.size());
  write_file(file, others + origin);
}

}  // namespace evodevo::tools
