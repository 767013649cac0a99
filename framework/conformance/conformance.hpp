// The conformance kit: test cases for the rules that every plugin must obey. Each case runs in a process of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "operators/loader.hpp"

namespace evodevo::conformance {

/// Thrown by a case that fails. what() describes the violation of the rule.
struct Violation : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Thrown by a case that does not apply to this operator. what() says why.
struct Skipped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A test case for one operator. `check` may crash, hang or change its process in any way.
struct Case {
  const char* name;
  void (*check)(const AvailableOperator& subject, std::uint64_t seed);
};

/// Returns cases for operators of every kind.
std::vector<Case> general_cases();
/// Returns further cases for operators of every kind: they check that operators keep no hidden state, leave the process
/// as it is, and have plain names and texts.
std::vector<Case> process_cases();
/// Returns the cases for operators of one kind.
std::vector<Case> laws_of(std::string_view kind);

/// The result of one case.
struct Verdict {
  std::string subject;  ///< kind and name of the operator, such as "devo erosion", or the library's file name
  std::string name;     ///< name of the case
  std::string outcome;  ///< "passed", "failed", "crashed" or "skipped"
  std::string reason;   ///< empty if the case passed
};

constexpr unsigned seconds_per_case = 60;

/// Runs all cases on all operators of a library, and reports each verdict as soon as it is known. `seed` determines all
/// inputs. A case that has not finished after `seconds` s counts as failed.
void examine(const std::filesystem::path& library, std::uint64_t seed,
             const std::function<void(const Verdict&)>& report, unsigned seconds = seconds_per_case);

}  // namespace evodevo::conformance
