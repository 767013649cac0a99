// Operators in use: what is recorded of them, and who is blamed for what they throw.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "operators/operator_call.hpp"

namespace evodevo {

/// An operator that an experiment uses.
struct OperatorUse {
  std::string kind, name, version;
  std::filesystem::path file;
  std::string hash;                      ///< of the file
  const OperatorTitle* title = nullptr;  ///< nullptr in a record
};

/// Throws std::runtime_error that names the call and `what`, and the remedy.
[[noreturn]] void blame_operator(const OperatorCall& call, const std::string& what);

/// Calls the own code of an operator, and blames it for what it throws. All such calls go through here, or, while an
/// experiment is being read, through in_operator().
template <class Call>
decltype(auto) call_operator(const OperatorCall& whose, const Call& call) {
  try {
    return in_operator(whose, call);
  } catch (const std::exception& error) {
    blame_operator(whose, error.what());
  }
}

}  // namespace evodevo
