// The operators that an experiment uses: what a run records about them, and errors that name the operator at fault.
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
  std::string hash;                      ///< hash of the file
  const OperatorTitle* title = nullptr;  ///< nullptr if read from the record of a run
  std::string label = {};                ///< given in the experiment, to tell two uses of one operator apart

  /// The label, or the name if there is no label.
  const std::string& own_name() const { return label.empty() ? name : label; }
};

/// Throws a std::runtime_error whose message names the call, says `what` went wrong, and gives a remedy.
[[noreturn]] void blame_operator(const OperatorCall& call, const std::string& what);

/// Calls an operator's code. If the code throws an exception, throws one that names the operator (blame_operator())
/// instead. All calls of operators go through this function or, while an experiment is read, through in_operator().
template <class Call>
decltype(auto) call_operator(const OperatorCall& whose, const Call& call) {
  try {
    return in_operator(whose, call);
  } catch (const std::exception& error) {
    blame_operator(whose, error.what());
  }
}

}  // namespace evodevo
