#include "conformance/conformance.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <ctime>
#include <optional>

#include "base/text.hpp"
#include "conformance/exports.hpp"
#include "operators/isolation.hpp"
#include "operators/surroundings.hpp"

namespace evodevo::conformance {
namespace {

namespace fs = std::filesystem;

constexpr double listing_limit = 0.1;  ///< longest CPU time for listing a library, s

/// Runs a check and returns its outcome, a newline and the reason. Must be called in a child process.
std::string tell(const std::function<void()>& check) {
  try {
    check();
    return "passed\n";
  } catch (const Skipped& reason) {
    return std::string("skipped\n") + reason.what();
  } catch (const std::exception& error) {
    return std::string("failed\n") + error.what();
  } catch (...) {
    return "failed\nit threw something that is not a std::exception";
  }
}

/// Runs one case after the other, as the examination wants it.
class Court {
 public:
  Court(const Examination& how, const std::function<void(const Verdict&)>& report) : how_(how), report_(report) {}

  /// Runs a case if it is wanted, and returns whether it passed.
  bool judge(const std::string& subject, const char* name, const std::function<void()>& check) const {
    return !is_wanted(name) || require(subject, name, check);
  }
  /// Runs a case on which others depend, and returns whether it passed. Does not report it if it passed and is not
  /// wanted.
  bool require(const std::string& subject, const char* name, const std::function<void()>& check) const {
    const Verdict verdict = how_.here ? told(subject, name, tell(check)) : judged_apart(subject, name, check);
    const bool has_passed = verdict.outcome == "passed";
    if (is_wanted(name) || !has_passed) report_(verdict);
    return has_passed;
  }

 private:
  bool is_wanted(std::string_view name) const { return how_.only_case.empty() || how_.only_case == name; }

  static Verdict told(const std::string& subject, const char* name, const std::string& text) {
    const auto newline = text.find('\n');
    return {subject, name, text.substr(0, newline), text.substr(newline + 1)};
  }

  /// Runs a case in a process of its own.
  Verdict judged_apart(const std::string& subject, const char* name, const std::function<void()>& check) const {
    const ChildEnd end = in_child([&] { return tell(check); }, how_.seconds);
    if (!end.crash.empty())
      return {subject, name, end.timed_out ? "failed" : "crashed",
              end.crash + "; to look at it in a debugger, give --case " + name + " --here"};
    return told(subject, name, end.text);
  }

  const Examination& how_;
  const std::function<void(const Verdict&)>& report_;
};

void loads(const fs::path& library) {
  const Surroundings before;
  dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);  // if this fails, the registry below gives the reason
  if (const std::string changed = before.restore(); !changed.empty())
    throw Violation("it changes " + changed + " while it is loaded; build it without -ffast-math");
  const Registry registry({library});
  if (!registry.failed().empty()) throw Violation(registry.failed().front().reason);
  if (registry.operators().empty()) throw Violation("it has no operator; name one in EVODEVO_PLUGIN(...)");
}

void exports_one_function(const fs::path& library) {
  const std::vector<std::string> found = exports(library);
  if (found != std::vector<std::string>{"evodevo_plugin"})
    throw Violation("exports " + joined(found) +
                    "; expected only evodevo_plugin: build it with evodevo_add_plugin or -fvisibility=hidden");
}

void lists_quickly(const fs::path& library) {
  const std::clock_t start = std::clock();
  const Registry registry({library});
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  if (seconds > listing_limit)
    throw Violation("listing its operators takes " + to_text(seconds * 1000) +
                    " ms; expected less than 100 ms: do the work in the calls, not in constructors");
}

/// Runs the cases for a library as a whole, unless only one operator is examined. Returns whether it can be loaded.
bool is_usable(const fs::path& library, const Court& court, const Examination& how) {
  if (!how.only_operator.empty()) return true;
  const std::string file = library.filename().string();
  if (!court.judge(file, "loads", [&] { loads(library); })) return false;
  court.judge(file, "exports", [&] { exports_one_function(library); });
  court.judge(file, "listing", [&] { lists_quickly(library); });
  return true;
}

/// Reads the experiment whose parameters and genomes the operators of the libraries are tried with. Throws Violation if
/// it uses none of them.
Experiment experiment_for(const std::vector<fs::path>& libraries, const std::string& file) {
  Experiment experiment = read_experiment({.file = file, .overrides = {}, .plugin_path = libraries});
  const auto is_tried = [&](const OperatorUse& use) {
    return std::any_of(libraries.begin(), libraries.end(),
                       [&](const fs::path& library) { return fs::equivalent(library, use.file); });
  };
  if (std::none_of(experiment.uses.begin(), experiment.uses.end(), is_tried))
    throw Violation("it uses no operator of the libraries; name an experiment that does");
  return experiment;
}

void try_operators(const std::vector<AvailableOperator>& operators, const Court& court, const Examination& how,
                   const Experiment* experiment) {
  for (const AvailableOperator& available : operators) {
    if (!how.only_operator.empty() && how.only_operator != available.entry->name) continue;
    const Subject subject{available, operators, experiment == nullptr ? std::nullopt : use_in(*experiment, available)};
    const std::string title = subject.kind() + " " + subject.name();
    for (const auto& cases : {general_cases(), process_cases(), laws_of(subject.kind())})
      for (const Case& one : cases) court.judge(title, one.name, [&] { one.check(subject, how.seed); });
  }
}

}  // namespace

void examine(const std::vector<fs::path>& libraries, const Examination& how,
             const std::function<void(const Verdict&)>& report) {
  const Court court(how, report);
  std::vector<fs::path> usable;
  for (const fs::path& library : libraries)
    if (is_usable(library, court, how)) usable.push_back(library);
  // only now, since this loads the libraries into this process
  std::optional<Experiment> experiment;
  if (!how.experiment.empty() && !usable.empty()) {
    const auto read = [&] { return experiment_for(usable, how.experiment); };
    if (!court.require(how.experiment, "experiment", read)) return;
    experiment = read();
  }
  for (const fs::path& library : usable) {
    const Registry registry({library});
    if (!registry.failed().empty()) report({library.filename(), "loads", "failed", registry.failed().front().reason});
    try_operators(registry.operators(), court, how, experiment ? &*experiment : nullptr);
  }
}

}  // namespace evodevo::conformance
