// Helpers for testing the command lines of several tools: a check that a help page describes exactly the options that a
// program takes, and a function that returns the error message about a command line.
#pragma once

#include <gtest/gtest.h>

#include <boost/program_options.hpp>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>

#include "common/program.hpp"

namespace evodevo::tools {

/// Returns the entry of an option in a help page: its line and the lines below it, up to the next option or an empty
/// line.
inline std::string described(const std::string& help, const std::string& option) {
  std::smatch found;
  const std::regex entry("\n  --" + option + "[ \n](?:.*)(?:\n   .*)*");
  return std::regex_search(help, found, entry) ? found.str() : "";
}

/// Expects that every option except positional ones has an entry, which names the default if there is one, and that
/// there are no other entries.
inline void expect_page_of_options(const Program& program, const boost::program_options::options_description& options,
                                   const std::set<std::string>& positional = {}) {
  const std::string help(program.help), name(program.name);
  int entries = 1;  // the entry of --help
  for (const auto& option : options.options()) {
    if (positional.count(option->long_name()) > 0) continue;
    ++entries;
    const std::string entry = described(help, option->long_name());
    EXPECT_NE(entry, "") << "--" << option->long_name() << " is missing in the help of tools/" << name;
    const bool is_flag = option->semantic()->max_tokens() == 0;
    const std::string parameter = option->semantic()->name();
    std::smatch standard;
    if (!is_flag && std::regex_match(parameter, standard, std::regex(".*\\(=(.*)\\)"))) {
      EXPECT_NE(entry.find("(" + standard.str(1) + ")"), entry.npos)
          << "the help of --" << option->long_name() << " does not name its default " << standard.str(1);
    }
  }
  const std::regex any("\n  --[a-z]");
  EXPECT_EQ(std::distance(std::sregex_iterator(help.begin(), help.end(), any), std::sregex_iterator()), entries)
      << "the help of tools/" << name << " describes an option that is not there";
  EXPECT_NE(help.find("\n  tools/" + name + " "), help.npos) << "there is no example";
}

/// Returns the message with which `parse` refuses a command line, or an empty string if it accepts the command line.
template <class Parse>
std::string complaint_about(const Parse& parse, const CommandLine& line) {
  try {
    parse(line);
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

}  // namespace evodevo::tools
