// The sub-commands of `evodevo`.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "base/input_error.hpp"

namespace evodevo {

using Arguments = std::vector<std::string>;

/// Every command takes what follows its name and returns the exit code: 0 done, 1 the run or simulation failed, 130
/// interrupted. Bad input is thrown as UsageError, ConfigError or ArchiveError (exit code 2). What it prints through
/// std::cout or stdio is checked when it is done (exit code 1).
int run_command(const Arguments& arguments);
int resume_command(const Arguments& arguments);
int check_command(const Arguments& arguments);
int verify_command(const Arguments& arguments);
int show_command(const Arguments& arguments);
int body_command(const Arguments& arguments);
int life_command(const Arguments& arguments);
int simulate_command(const Arguments& arguments);
int environments_command(const Arguments& arguments);
int operators_command(const Arguments& arguments);
int describe_command(const Arguments& arguments);
int new_command(const Arguments& arguments);
int conform_command(const Arguments& arguments);
int report_command(const Arguments& arguments);
int gallery_command(const Arguments& arguments);
int film_command(const Arguments& arguments);

/// A command line that does not make sense.
struct UsageError : InputError {
  using InputError::InputError;
};

}  // namespace evodevo
