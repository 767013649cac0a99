#include <cmath>

#include "base/text.hpp"
#include "experiment/tables/declarations.hpp"
#include "experiment/tables/tables.hpp"

namespace evodevo {
namespace {

/// Reports if a cycle is too short for a tally.
void check_skip(const TomlReader& t, const Settings& settings) {
  const DevelopmentSettings& development = settings.development;
  if (development.probe != Probe::skip_shift || !settings.step.fixed()) return;
  const double steps = std::round(development.cycle_time / *settings.step.fixed());
  if (static_cast<double>(development.skip) > steps)
    t.report("skip", "a cycle of " + to_text(steps) + " steps would have no tally; expected at most " + to_text(steps),
             {"development", "simulation"});
}

}  // namespace

void read_development(TomlReader& t, Settings& settings) {
  if (t.has("operator")) settings.development.cycles = 100;
  declare_development(t, settings);
  t.expect({"operator"});
  settings.step.unit = settings.development.cycle_time;
  check_duration(t, "cycle_time", settings.development.cycle_time, settings.step);
  check_skip(t, settings);
}

}  // namespace evodevo
