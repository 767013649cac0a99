#include "conformance/conformance.hpp"

#include <dlfcn.h>

#include <ctime>

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

Verdict judge(const std::string& subject, const char* name, unsigned seconds, const std::function<void()>& check) {
  const ChildEnd end = in_child([&] { return tell(check); }, seconds);
  if (end.timed_out) return {subject, name, "failed", end.crash};
  if (!end.crash.empty()) return {subject, name, "crashed", end.crash};
  const auto newline = end.text.find('\n');
  return {subject, name, end.text.substr(0, newline), end.text.substr(newline + 1)};
}

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

}  // namespace

void examine(const fs::path& library, std::uint64_t seed, const std::function<void(const Verdict&)>& report,
             unsigned seconds) {
  const std::string file = library.filename().string();
  const Verdict loaded = judge(file, "loads", seconds, [&] { loads(library); });
  report(loaded);
  if (loaded.outcome != "passed") return;
  report(judge(file, "exports", seconds, [&] { exports_one_function(library); }));
  report(judge(file, "listing", seconds, [&] { lists_quickly(library); }));

  const Registry registry({library});
  for (const AvailableOperator& subject : registry.operators()) {
    const std::string title = std::string(subject.entry->kind) + " " + subject.entry->name;
    for (const auto& cases : {general_cases(), process_cases(), laws_of(subject.entry->kind)})
      for (const Case& one : cases) report(judge(title, one.name, seconds, [&] { one.check(subject, seed); }));
  }
}

}  // namespace evodevo::conformance
