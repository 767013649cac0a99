// The conformance kit: test cases for the rules that every plugin must obey. Each case runs in a process of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "conformance/subject.hpp"

namespace evodevo::conformance {

/// A test case for one operator. `check` may crash, hang or change its process in any way.
struct Case {
  const char* name;
  void (*check)(const Subject& subject, std::uint64_t seed);
};

/// Returns cases for operators of every kind.
std::vector<Case> general_cases();
/// Returns further cases for operators of every kind: they check that operators keep no hidden state, leave the process
/// as it is, and have plain names and texts.
std::vector<Case> process_cases();
/// Returns the cases for operators of one kind.
std::vector<Case> laws_of(std::string_view kind);
std::vector<Case> selection_laws();

/// The result of one case.
struct Verdict {
  std::string subject;  ///< kind and name of the operator, such as "devo erosion", or the library's file name
  std::string name;     ///< name of the case
  std::string outcome;  ///< "passed", "failed", "crashed" or "skipped"
  std::string reason;   ///< empty if the case passed
};

/// What is examined, and how.
struct Examination {
  std::uint64_t seed = 1;                ///< determines all inputs
  std::string only_operator, only_case;  ///< names; empty: all
  bool here = false;                     ///< whether cases run in this process, without a time limit, for a debugger
  /// The file of an experiment that gives parameters and genomes to the operators that it uses; empty: none.
  std::string experiment;
  unsigned seconds = 60;  ///< a case that has not finished after this time counts as failed
};

/// Runs the cases for libraries and their operators, and reports each verdict as soon as it is known. The order: the
/// cases for each library; the case "experiment", which reads the experiment if there is one; the cases for each
/// operator. If the experiment cannot be used, the operators are not tried.
void examine(const std::vector<std::filesystem::path>& libraries, const Examination& how,
             const std::function<void(const Verdict&)>& report);

}  // namespace evodevo::conformance
