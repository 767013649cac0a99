// evodevo conform: checks whether plugins follow the rules for operators.
#include <fmt/ostream.h>

#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "base/json_text.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "conformance/conformance.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using conformance::Verdict;

void print(const Verdict& verdict) {
  fmt::print(std::cout, "{:<8} {:<28} {}{}{}\n", verdict.outcome, verdict.subject, verdict.name,
             verdict.reason.empty() ? "" : ": ", printable(verdict.reason, 2000));
  std::cout << std::flush;  // before the next fork, so that the child process does not print the line again
}

conformance::Examination examination(const Given& given) {
  if (given["seed"].as<std::int64_t>() < 0)
    throw UsageError("--seed " + std::to_string(given["seed"].as<std::int64_t>()) + ": expected 0 or more");
  conformance::Examination how;
  how.seed = static_cast<std::uint64_t>(given["seed"].as<std::int64_t>());
  if (given.contains("operator")) how.only_operator = given["operator"].as<std::string>();
  if (given.contains("case")) how.only_case = given["case"].as<std::string>();
  if (given.contains("experiment")) how.experiment = given["experiment"].as<std::string>();
  how.here = given.contains("here");
  if (how.here && how.only_case.empty())
    throw UsageError("--here: expected one case, because one may end the process; give --case NAME");
  return how;
}

/// Throws UsageError, because there is no operator or case of the names that are given.
[[noreturn]] void refuse_names(const conformance::Examination& how) {
  std::string wanted;
  if (!how.only_operator.empty()) wanted = option_text("operator", how.only_operator);
  if (!how.only_case.empty()) wanted += (wanted.empty() ? "" : " ") + option_text("case", how.only_case);
  throw UsageError(wanted +
                   ": the libraries have no such operator or case; call conform without this to see the names");
}

int conform(const Given& given) {
  const auto libraries = given["LIBRARY"].as<std::vector<std::string>>();
  for (const std::string& library : libraries)
    if (std::error_code error; !std::filesystem::is_regular_file(library, error))
      throw UsageError("conform " + printable(library) +
                       ": is not a file; give the libraries to check, NAME.evodevo.so");
  const conformance::Examination how = examination(given);
  const bool as_json = given.contains("json");
  std::map<std::string, std::size_t> counts;
  Json list = Json::array();
  std::map<std::pair<std::string, std::string>, std::string> told;  // the first case of each reason
  const auto report = [&](const Verdict& verdict) {
    ++counts[verdict.outcome];
    if (as_json)
      list.push_back({{"subject", verdict.subject},
                      {"case", verdict.name},
                      {"outcome", verdict.outcome},
                      {"reason", verdict.reason},
                      {"seed", how.seed}});
    else if (const auto [first, is_new] = told.emplace(std::pair(verdict.subject, verdict.reason), verdict.name);
             is_new || verdict.reason.empty())
      print(verdict);
    else
      print({verdict.subject, verdict.name, verdict.outcome, "as in " + first->second});
  };
  std::vector<fs::path> paths;
  for (const std::string& library : libraries) paths.push_back(fs::absolute(library).lexically_normal());
  conformance::examine(paths, how, report);
  if (counts.empty()) refuse_names(how);
  const std::size_t bad = counts["failed"] + counts["crashed"];
  if (as_json)
    std::cout << json_text(list) << '\n';
  else
    std::cout << counts["passed"] << " passed, " << counts["skipped"] << " skipped, " << bad << " failed; --seed "
              << how.seed << " repeats them\n";
  return bad == 0 ? 0 : 1;
}

}  // namespace

Command conform_command() {
  Options options;
  options.add_options()("experiment", value<std::string>("FILE.toml"),
                        "try the operators that this experiment uses with its parameters and genomes")(
      "operator", value<std::string>("NAME"), "try only this operator")("case", value<std::string>("NAME"),
                                                                        "run only this case")(
      "here", "run the case in this process, without a time limit, for a debugger")(
      "seed", value<std::int64_t>("N")->default_value(1), "seed of all inputs")("json", "print JSON");
  return {
      .name = "conform",
      .arguments = {{"LIBRARY", Count::one_or_more}},
      .summary = "Check whether plugins follow the rules for operators",
      .text =
          {"It calls the operators of each library with many inputs and checks what evodevo relies on, such as "
           "equal results for equal inputs. Each case runs in a process of its own, so a crash fails only one case.",
           "Operators are tried with their default parameters, and variation operators with generated genomes or, if "
           "they work on blocks of certain types, with those of an encoding of the same library. With --experiment, "
           "the operators that the experiment uses are tried with the parameters of their tables, its materials and "
           "its genomes. This is needed for operators that require a file."},
      .examples = {"conform build/lib/evodevo/growth.evodevo.so",
                   "conform growth.evodevo.so --experiment experiment.toml",
                   "conform growth.evodevo.so --operator my-lab.growth --case bodies --here"},
      .options = options,
      .function = conform,
      .watches_operators = false};  // because each case runs in a process of its own with a time limit
}

}  // namespace evodevo
