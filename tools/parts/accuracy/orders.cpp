#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes.hpp"
#include "studies.hpp"
#include "threads/parallel.hpp"

namespace evodevo::tools::accuracy {
namespace {

/// Errors below this value are due to rounding and to the error of the reference solution.
constexpr double smallest_error = 3e-11;

/// How many of the smallest usable time steps are used for fitting the order.
constexpr std::size_t smallest = 4;

bool contact_bears(double dt) { return dt <= 0.0005; }

/// The longest step with which a trial of `duration` s is simulated, s.
double longest_dt(double duration) { return duration / 100; }

int theoretical_order(Method method) {
  if (method == Method::rk4) return 4;
  return method == Method::velocity_verlet ? 2 : 1;
}

struct Sweep {
  const Trial* trial;
  Method method;
  std::vector<double> dt, error;

  /// The least-squares slope of log error against log dt. Without contact, the fit uses the smallest dt whose errors
  /// are above `smallest_error`. With contact, errors scatter, and the fit uses all dt at which contact is stable.
  double observed_order() const {
    std::size_t end = error.size();
    while (end > smallest && !(error[end - 1] > smallest_error)) --end;
    std::size_t begin = end - smallest;
    if (!trial->smooth)
      begin = static_cast<std::size_t>(std::find_if(dt.begin(), dt.end(), contact_bears) - dt.begin());
    const auto points = static_cast<double>(end - begin);
    double x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const double log_dt = std::log(dt[i]), log_error = std::log(error[i]);
      x += log_dt / points, y += log_error / points;
      xx += log_dt * log_dt / points, xy += log_dt * log_error / points;
    }
    return (xy - x * y) / (xx - x * x);
  }
};

void run(Sweep& sweep, int halvings) {
  const Trial& trial = *sweep.trial;
  for (int i = 0; i <= halvings; ++i) {
    const double dt = longest_dt(trial.duration) / (1 << i);
    const Traveller t =
        simulate(trial.body, trial.start, trial.scene, {sweep.method, Precision::float64, dt}, trial.duration);
    sweep.dt.push_back(dt);
    sweep.error.push_back(t.alive() ? trial.error(t.state) : std::numeric_limits<double>::quiet_NaN());
    if (sweep.error.back() < smallest_error) break;
  }
}

}  // namespace

std::vector<Table> orders(const Settings& settings) {
  Workers workers(settings.device.threads);
  const int halvings = settings.quick ? 8 : 10;
  const double finest = longest_dt(0.4) / (1 << halvings) / 16;
  const std::vector<std::function<Trial()>> scenes = {
      spring_trial,     lattice_trial, drop_trial, slide_trial, [&] { return rigid_drop_trial(finest); },
      rigid_slide_trial};
  std::vector<Trial> trials(scenes.size());
  workers.for_each(scenes.size(), [&](std::size_t i) { trials[i] = scenes[i](); });
  std::vector<Sweep> sweeps;
  for (const Trial& trial : trials)
    for (const Method method : all_methods()) sweeps.push_back({&trial, method, {}, {}});
  workers.for_each(sweeps.size(), [&](std::size_t i) { run(sweeps[i], halvings); });

  Table errors("convergence", {"scene", "contact", "method", "dt (s)", "error (1)"});
  Table found("orders", {"scene", "contact", "method", "order in theory", "observed order"});
  for (const Sweep& sweep : sweeps) {
    const std::string contact = sweep.trial->smooth ? "no" : "yes", method(name(sweep.method));
    for (std::size_t i = 0; i < sweep.dt.size(); ++i)
      errors.add({sweep.trial->name, contact, method, sweep.dt[i], sweep.error[i]});
    found.add({sweep.trial->name, contact, method, static_cast<double>(theoretical_order(sweep.method)),
               sweep.observed_order()});
  }
  return {errors, found};
}

}  // namespace evodevo::tools::accuracy
