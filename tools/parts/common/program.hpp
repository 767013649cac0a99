// Code that the measuring programs share: their main function, their command line, and the record of where their
// results come from.
#pragma once

#include <boost/program_options.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace evodevo::tools {

struct Program {
  std::string_view name;  ///< name of its script in tools/
  std::string_view help;  ///< its page of help; the script can print it too, without building the program
};

using CommandLine = std::vector<std::string>;  ///< the arguments, without the program's name

/// Implements `main`: prints the page of help if `--help` is among the arguments, and calls `run` otherwise. Returns
/// the exit status. After an exception, prints its message and returns 2.
int run_program(const Program& program, int argc, const char* const* argv,
                const std::function<void(const CommandLine&)>& run);

/// Parses the command line and stores the values of `options`. Throws a Boost exception that names an option if it is
/// unknown or malformed.
boost::program_options::variables_map read_options(
    const CommandLine& line, const boost::program_options::options_description& options,
    const boost::program_options::positional_options_description& positional = {});

/// Returns the command that repeats a call; words in `omitted` are left out.
std::string command_of(const Program& program, const CommandLine& line, const std::vector<std::string>& omitted = {});

/// Throws std::invalid_argument if the first argument is not the name of a folder for results.
void require_folder(const Program& program, const CommandLine& line);

/// Throws std::invalid_argument if `value` is not one of `known`.
void check_choice(const std::string& option, const std::string& value, const std::vector<std::string>& known);

/// Throws std::invalid_argument if this program cannot compute on that device.
void check_device(const std::string& device);

/// Writes origin.txt, which names the command and the device that produced the results in a folder. If `keeps`, those
/// of commands that produced other results there stay in front of it.
void write_origin(const std::filesystem::path& folder, const std::string& command, const std::string& device,
                  bool keeps = false);

}  // namespace evodevo::tools
