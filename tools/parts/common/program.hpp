// What the measuring programs share: how each starts and ends, its command line, and the origin of what it writes.
#pragma once

#include <boost/program_options.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace evodevo::tools {

struct Program {
  std::string_view name;  ///< of its script in tools/
  std::string_view help;  ///< its page of help, which the script prints as well, before anything is built
};

using CommandLine = std::vector<std::string>;  ///< the arguments alone

/// The whole of `main`: prints the page of help where `--help` is among the arguments, calls `run` otherwise. Returns
/// the exit status: 2 after an exception, whose message it prints.
int run_program(const Program& program, int argc, const char* const* argv,
                const std::function<void(const CommandLine&)>& run);

/// Stores the values of `options`. Throws a boost exception that names an option that is unknown or malformed.
boost::program_options::variables_map read_options(
    const CommandLine& line, const boost::program_options::options_description& options,
    const boost::program_options::positional_options_description& positional = {});

/// The command that repeats a call, without the words in `omitted`.
std::string command_of(const Program& program, const CommandLine& line, const std::vector<std::string>& omitted = {});

/// Throws std::invalid_argument where the first argument is not a folder for results.
void require_folder(const Program& program, const CommandLine& line);

/// Throws std::invalid_argument where `value` is none of `known`.
void check_choice(const std::string& option, const std::string& value, const std::vector<std::string>& known);

/// Throws std::invalid_argument where this program cannot compute on that device.
void check_device(const std::string& device);

/// Writes origin.txt, which names the command and the device that made a folder of results.
void write_origin(const std::filesystem::path& folder, const std::string& command, const std::string& device);

}  // namespace evodevo::tools
