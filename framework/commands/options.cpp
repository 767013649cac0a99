#include "options.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <iostream>
#include <limits>

#include "base/text.hpp"
#include "experiment/toml_reader.hpp"

namespace evodevo {

namespace po = boost::program_options;
namespace fs = std::filesystem;

namespace {

/// Throws UsageError where the standard output goes into `input`, or into the run in that folder.
void refuse_to_print_into(const std::string& input) {
  struct stat output = {}, read = {};
  if (fstat(STDOUT_FILENO, &output) != 0 || !S_ISREG(output.st_mode)) return;
  for (const fs::path& file : {fs::path(input), fs::path(input) / database_name})
    if (stat(file.c_str(), &read) == 0 && read.st_dev == output.st_dev && read.st_ino == output.st_ino)
      throw UsageError(file.string() + ": is to be read, but the standard output goes into it; send that elsewhere");
}

}  // namespace

std::optional<po::variables_map> parse(CommandLine line, const Arguments& arguments) {
  line.options.add_options()("help", "show this text");
  po::options_description all = line.options;
  po::positional_options_description positional;
  for (const std::string& name : line.positional) {
    all.add_options()(name.c_str(), po::value<std::string>());
    positional.add(name.c_str(), 1);
  }
  if (!line.repeated.empty()) positional.add(line.repeated.c_str(), -1);
  po::variables_map given;
  try {
    po::store(po::command_line_parser(arguments).options(all).positional(positional).run(), given);
  } catch (const po::error& error) {
    throw UsageError(printable(error.what()) + "; usage: " + program_name() + " " + line.usage);
  }
  if (given.contains("help")) {
    std::cout << "usage: " << program_name() << ' ' << line.usage << '\n' << line.options;
    return std::nullopt;
  }
  for (const std::string& name : line.positional)
    if (!given.contains(name)) throw UsageError(name + " is missing; usage: " + program_name() + " " + line.usage);
  for (const std::string& name : line.positional) refuse_to_print_into(given[name].as<std::string>());
  if (given.contains(line.repeated))
    for (const std::string& input : given[line.repeated].as<std::vector<std::string>>()) refuse_to_print_into(input);
  return given;
}

void refuse_to_overwrite(const std::string& option, const fs::path& file, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs)
    if (std::error_code error; fs::equivalent(file, input, error))
      throw UsageError(option + " " + file.string() + ": is " + input.string() +
                       ", which is read; name another file to write");
}

std::vector<fs::path> libraries_of(const Experiment& experiment) {
  std::vector<fs::path> libraries;
  for (const OperatorUse& use : experiment.uses) libraries.push_back(use.file);
  return libraries;
}

std::vector<fs::path> files_of_run(const fs::path& folder) {
  const fs::path database = folder / database_name;
  return {database, database.string() + "-wal", database.string() + "-shm"};
}

namespace {

struct Shorthand {
  const char* option;
  const char* key;
  const char* text;
};

constexpr Shorthand shorthands[] = {
    {"seed", "experiment.seed", "seed of all random numbers"},
    {"device", "simulation.device", "where to simulate: auto, cpu or cuda"},
    {"threads", "simulation.threads", "threads on the CPU; 0 for all cores"},
};

/// An option and its value, as a message shows them.
std::string option_text(const std::string& option, const std::string& value) {
  return "--" + option + " " + printable(value);
}

}  // namespace

void add_plugin_option(po::options_description& options) {
  options.add_options()("plugin-path", po::value<std::vector<std::string>>(),
                        "folder with operators, or one library; comes after the experiment's own paths and before "
                        "EVODEVO_PLUGIN_PATH; may be repeated");
}

std::vector<std::filesystem::path> given_plugin_path(const po::variables_map& given) {
  std::vector<std::filesystem::path> path;
  if (!given.contains("plugin-path")) return path;
  for (const std::string& item : given["plugin-path"].as<std::vector<std::string>>()) {
    if (!is_plugin_path(item))
      throw UsageError(option_text("plugin-path", item) +
                       ": is no folder and no library NAME.evodevo.so; build the plugin first");
    path.emplace_back(item);
  }
  return path;
}

void add_experiment_options(po::options_description& options) {
  add_plugin_option(options);
  for (const Shorthand& shorthand : shorthands)
    options.add_options()(shorthand.option, po::value<std::string>(), shorthand.text);
  options.add_options()("set", po::value<std::vector<std::string>>(),
                        "key=value for any key of the file, such as experiment.population=20 or fitness.0.window=5; "
                        "may be repeated");
}

ExperimentSource experiment_source(const std::string& file, const po::variables_map& given) {
  ExperimentSource source{file, {}, given_plugin_path(given)};
  if (given.contains("set")) {
    for (const std::string& text : given["set"].as<std::vector<std::string>>()) {
      const auto equals = text.find('=');
      if (equals == std::string::npos || equals == 0)
        throw UsageError(option_text("set", text) + ": expected --set key=value");
      source.overrides.push_back({text.substr(0, equals), text.substr(equals + 1), option_text("set", text)});
    }
  }
  for (const Shorthand& shorthand : shorthands) {
    if (!given.contains(shorthand.option)) continue;
    const auto value = given[shorthand.option].as<std::string>();
    source.overrides.push_back({shorthand.key, value, option_text(shorthand.option, value)});
  }
  return source;
}

ArchivedIndividual individual_named(const Archive& archive, std::int64_t id) {
  const std::string folder = archive.folder().string();
  const bool is_id = id >= 0 && id <= std::numeric_limits<std::uint32_t>::max();
  auto individual = is_id ? archive.individual(static_cast<std::uint32_t>(id)) : std::nullopt;
  if (!individual)
    throw ArchiveError(folder + ": there is no individual " + std::to_string(id) + "; see `" + program_name() +
                       " show " + folder + "`");
  return *individual;
}

ArchivedIndividual chosen_individual(const Archive& archive, const po::variables_map& given) {
  if (given.contains("individual")) return individual_named(archive, given["individual"].as<std::int64_t>());
  const auto best = archive.best(1);
  if (best.empty())
    throw ArchiveError(archive.folder().string() + ": no individual has a fitness; name one with --individual");
  return archive.known_individual(best.front());
}

}  // namespace evodevo
