// Measures the spring evaluations per second of our simulator and of the paper's methods.
#include <hwy/targets.h>

#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <stdexcept>

#include "settings.hpp"
#include "studies.hpp"

namespace evodevo::tools::bench {
namespace {

/// Limits the simulator to the given instruction set and older ones, so that instruction sets can be compared.
void limit_instructions(const std::string& name) {
  const std::map<std::string, std::int64_t> limits{
      {"best", 0}, {"avx2", HWY_AVX2 | HWY_SSE4 | HWY_SCALAR}, {"sse4", HWY_SSE4 | HWY_SCALAR}, {"none", HWY_SCALAR}};
  hwy::SetSupportedTargetsForTest(limits.at(name));
}

Report measure(const Settings& settings) {
  limit_instructions(settings.instructions);
  const std::map<std::string, std::function<Report(const Settings&)>> studies{
      {"speed", speed},
      {"sizes", sizes},
      {"numbers", numbers},
      {"features", feature_costs},
      {"samples", sample_costs},
#ifdef EVODEVO_CUDA
      {"baselines", baselines},
      {"stress", stress_costs},
      {"tallies", tally_agreement},
      {"neighbours", neighbours},
      {"materials", material_costs},
      {"host", host_work},
#endif
  };
  return studies.at(settings.study)(settings);
}

Report read_reports(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + ": cannot be read");
  try {
    const Report report = Report::parse(stream);
    for (const Report& one : report.is_array() ? report : Report::array({report}))
      if (!is_report(one)) throw std::runtime_error("it holds something else");
    return report;
  } catch (const std::exception& error) {
    throw std::runtime_error(file + ": is not JSON that this program has written: " + error.what());
  }
}

void run(const Settings& settings) {
  const Report report = settings.tables.empty() ? measure(settings) : read_reports(settings.tables);
  if (settings.json) {
    std::cout << report.dump(2, ' ', false, Report::error_handler_t::replace) << '\n';
    return;
  }
  const Report list = report.is_array() ? report : Report::array({report});
  for (const Report& one : list) std::cout << (&one == &list.front() ? "" : "\n") << markdown(one);
}

}  // namespace
}  // namespace evodevo::tools::bench

int main(int argc, char** argv) {
  using namespace evodevo::tools;
  return run_program(bench::program, argc, argv, [](const CommandLine& line) { bench::run(bench::parse(line)); });
}
