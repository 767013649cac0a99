// evodevo conform: whether plugins keep to what the host relies on.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/json_text.hpp"
#include "base/text.hpp"
#include "commands/options.hpp"
#include "conformance/conformance.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;
using conformance::Verdict;
namespace po = boost::program_options;

void print(const Verdict& verdict) {
  std::printf("%-8s %-28s %s%s%s\n", verdict.outcome.c_str(), verdict.subject.c_str(), verdict.name.c_str(),
              verdict.reason.empty() ? "" : ": ", printable(verdict.reason, 2000).c_str());
  std::fflush(stdout);  // a child that crashes next must not say it again
}

bool is_good(const Verdict& verdict) { return verdict.outcome == "passed" || verdict.outcome == "skipped"; }

}  // namespace

int conform_command(const Arguments& arguments) {
  CommandLine line{"conform LIBRARY... [--seed N] [--json]", {}, {}};
  line.options.add_options()("libraries", po::value<std::vector<std::string>>(), "the libraries, NAME.evodevo.so")(
      "seed", po::value<std::int64_t>()->default_value(1), "seed of all inputs")("json", "machine-readable");
  line.repeated = "libraries";
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  if (!given->contains("libraries")) throw UsageError("conform: give the libraries to check, NAME.evodevo.so");
  const auto libraries = (*given)["libraries"].as<std::vector<std::string>>();
  for (const std::string& library : libraries)
    if (std::error_code error; !std::filesystem::is_regular_file(library, error))
      throw UsageError("conform " + printable(library) + ": is no file; give the libraries to check, NAME.evodevo.so");
  if ((*given)["seed"].as<std::int64_t>() < 0) throw UsageError("conform --seed: expected 0 or more");
  const auto seed = static_cast<std::uint64_t>((*given)["seed"].as<std::int64_t>());
  const bool as_json = given->contains("json");
  std::size_t cases = 0, bad = 0;
  Json list = Json::array();
  const auto report = [&](const Verdict& verdict) {
    ++cases;
    bad += !is_good(verdict);
    if (as_json)
      list.push_back({{"subject", verdict.subject},
                      {"case", verdict.name},
                      {"outcome", verdict.outcome},
                      {"reason", verdict.reason},
                      {"seed", seed}});
    else
      print(verdict);
  };
  for (const auto& library : libraries)
    conformance::examine(std::filesystem::absolute(library).lexically_normal(), seed, report);
  if (as_json)
    std::cout << json_text(list) << '\n';
  else
    std::cout << cases << " cases, " << bad << " not kept; --seed " << seed << " repeats them\n";
  return bad == 0 ? 0 : 1;
}

}  // namespace evodevo
