#include <string>
#include <vector>

#include "batch.hpp"
#include "studies.hpp"

namespace evodevo::tools::bench {
namespace {

/// Measures the rates of one body alternately with its materials in a table and with computed materials.
class Comparison {
 public:
  Comparison(const Settings& settings, const Body& body)
      : table_(settings, {&body, 1}, walking_scene(), Materials::table),
        computed_(settings, {&body, 1}, walking_scene(), Materials::computed) {
    for (Batch* batch : {&table_, &computed_})
      for (const Recording recording : {Recording{}, Recording{.stress = true}}) batch->rate(recording);  // warm-up
  }

  std::string device() const { return table_.device(); }

  Report row(std::size_t materials, int runs) {
    std::vector<double> table, computed, ratios, stress_ratios;
    for (int run = 0; run < runs; ++run) {
      table.push_back(table_.rate().device);
      computed.push_back(computed_.rate().device);
      ratios.push_back(computed.back() / table.back());
      stress_ratios.push_back(computed_.rate({.stress = true}).device / table_.rate({.stress = true}).device);
    }
    return {{"materials", materials},
            {"rate_with_a_table", median(table)},
            {"rate_computed", median(computed)},
            {"ratio", median(ratios)},
            {"ratio_with_stress", median(stress_ratios)}};
  }

 private:
  Batch table_, computed_;
};

}  // namespace

Report material_costs(const Settings& settings) {
  const NamedBody own = body_named(settings.body, settings.masses);
  Report rows = Report::array();
  std::string device;
  for (const std::uint32_t count : {5, 15, 200, 1000, 5000, 14000}) {
    const NamedBody body = body_named(settings.body, settings.masses, count);
    Comparison comparison(settings, body.body);
    rows.push_back(comparison.row(count, settings.runs));
    device = comparison.device();
  }
  Report report = conditions(settings, "Materials from a table and computed", device, own);
  report.erase("materials");
  report["note"] =
      "Rates are medians of spring evaluations per second, for the time steps alone; a ratio is the median of the "
      "ratios within each run. Each row says how many materials there are; the springs take them in turn.";
  report["rows"] = std::move(rows);
  return report;
}

}  // namespace evodevo::tools::bench
