// Compares the paper's two simulators with ours on the same bodies.
#include <string>
#include <vector>

#include "batch.hpp"
#include "paper/candidates.hpp"
#include "studies.hpp"

namespace evodevo::tools::bench {

Report baselines(const Settings& settings) {
  const NamedBody body = body_named(settings.body, settings.masses, settings.materials);
  Batch ours(settings, {&body.body, 1}, walking_scene());
  const Candidate global = fastest(settings, body.body, MassMemory::global);
  const Candidate shared = fastest(settings, body.body, MassMemory::shared);
  TimedMethod with_global(settings, body.body, global.method), with_shared(settings, body.body, shared.method);
  ours.rate();  // warm-up
  std::vector<double> rates_ours, rates_global, rates_shared, over_global, over_shared, shared_over_global;
  for (int run = 0; run < settings.runs; ++run) {
    rates_ours.push_back(ours.rate().device);
    rates_global.push_back(with_global.rate());
    rates_shared.push_back(with_shared.rate());
    over_global.push_back(rates_ours.back() / rates_global.back());
    over_shared.push_back(rates_ours.back() / rates_shared.back());
    shared_over_global.push_back(rates_shared.back() / rates_global.back());
  }
  const auto row = [](const std::string& simulator, const std::vector<double>& rates, double ratio) {
    return Report{
        {"simulator", simulator}, {"spring_evaluations_per_second", median(rates)}, {"over_the_first", ratio}};
  };
  Report report = conditions(settings, "The paper's simulators and ours", ours.device(), body);
  report["ours_over_the_paper's_method"] = median(over_shared);
  report["note"] =
      "Rates are medians, from the device time of the time steps alone; a ratio is the median of the ratios within "
      "each "
      "run. The first two simulators are plain versions of what the paper describes, without guards, each with the "
      "fastest of " +
      std::to_string(global.tried) +
      " combinations of spring order and block size that this run tried; ours has its guards on.";
  report["rows"] = Report::array(
      {row("masses in global memory, a kernel for the springs and one for the masses in each step, float atomics; " +
               description(global.method),
           rates_global, 1),
       row("the paper's method: masses in shared memory, a kernel for each step, float atomics; " +
               description(shared.method),
           rates_shared, median(shared_over_global)),
       row("ours: bodies stay on the chip, integer atomics", rates_ours, median(over_global))});
  return report;
}

}  // namespace evodevo::tools::bench
