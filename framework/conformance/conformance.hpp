// The conformance kit: what every plugin has to keep to, one case after the other, each in a process of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "operators/loader.hpp"

namespace evodevo::conformance {

/// Thrown by a case that does not pass. what() says what was expected and what came.
struct Violation : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Thrown by a case that cannot say anything about this operator. what() says why.
struct Skipped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Something to check of one operator. It may crash, hang and change the process as it likes.
struct Case {
  const char* name;
  void (*check)(const AvailableOperator& subject, std::uint64_t seed);
};

/// The cases for operators of every kind.
std::vector<Case> general_cases();
/// More of them: what operators leave as it is in the process, and what they call things.
std::vector<Case> process_cases();
/// The laws of one kind.
std::vector<Case> laws_of(std::string_view kind);

struct Verdict {
  std::string subject;  ///< "devo erosion", or the library's file name
  std::string name;     ///< of the case
  std::string outcome;  ///< "passed", "failed", "crashed" or "skipped"
  std::string reason;   ///< empty where it passed
};

constexpr unsigned seconds_per_case = 60;

/// Runs all cases on all operators of a library; `seed` makes all inputs. Reports each verdict as it comes. A case that
/// is not done after `seconds` is not kept.
void examine(const std::filesystem::path& library, std::uint64_t seed,
             const std::function<void(const Verdict&)>& report, unsigned seconds = seconds_per_case);

}  // namespace evodevo::conformance
