// The cost of recording stress (paper, section IV-D1, Figures 2 and 4).
#include <memory>
#include <string>
#include <vector>

#include "batch.hpp"
#include "paper/candidates.hpp"
#include "paper/stress_methods.hpp"
#include "studies.hpp"

namespace evodevo::tools::bench {
namespace {

Report row(const std::string& method, const std::vector<double>& rates, const std::vector<double>& ratios) {
  return {
      {"stress", method}, {"spring_evaluations_per_second", median(rates)}, {"of_the_rate_without", median(ratios)}};
}

/// Returns the rows of the paper's method: first `plain`, which records no stress, then each way of recording stress.
Report paper_rows(const Settings& settings, const Body& body, const PaperMethod& plain) {
  TimedMethod without(settings, body, plain);
  std::vector<double> rates_without;
  Report rows;
  for (const auto& [name, method] : stress_methods(plain)) {
    TimedMethod with(settings, body, method);
    std::vector<double> rates, ratios;
    for (int run = 0; run < settings.runs; ++run) {
      rates_without.push_back(without.rate());
      rates.push_back(with.rate());
      ratios.push_back(rates.back() / rates_without.back());
    }
    rows.push_back(row("the paper's method, " + name, rates, ratios));
  }
  rows.insert(rows.begin(), row("the paper's method, none", rates_without, {1}));
  return rows;
}

void add_our_rows(const Settings& settings, Batch& ours, Report& rows) {
  ours.rate();  // warm-up
  ours.rate({.stress = true});
  std::vector<double> plain, stress, ratios;
  for (int run = 0; run < settings.runs; ++run) {
    plain.push_back(ours.rate().device);
    stress.push_back(ours.rate({.stress = true}).device);
    ratios.push_back(stress.back() / plain.back());
  }
  rows.push_back(row("ours, none", plain, {1}));
  rows.push_back(row("ours, exact sums in registers", stress, ratios));
}

}  // namespace

Report stress_costs(const Settings& settings) {
  const NamedBody body = body_named(settings.body, settings.masses, settings.materials);
  const PaperMethod plain = fastest(settings, body.body, MassMemory::shared).method;
  Batch ours(settings, {&body.body, 1}, walking_scene());
  Report rows = paper_rows(settings, body.body, plain);
  add_our_rows(settings, ours, rows);
  Report report = conditions(settings, "What stress costs", ours.device(), body);
  report["the_paper's_method"] = description(plain);
  report["note"] =
      "Rates are medians, from the device time of the time steps alone; a ratio is the median of the ratios within "
      "each "
      "run. Skip-Shift divides the springs into as many groups as a block has threads, and looks up their random order "
      "only in steps with a tally.";
  report["rows"] = std::move(rows);
  return report;
}

}  // namespace evodevo::tools::bench
