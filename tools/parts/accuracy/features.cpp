#include "bench/studies.hpp"
#include "studies.hpp"

namespace evodevo::tools::accuracy {

std::vector<Table> features(const Settings& settings) {
  bench::Settings measured;
  measured.command = settings.command;
  measured.device = settings.device.name;
  measured.threads = settings.device.threads;
  measured.body = "knn1000";
  measured.masses = 1000;
  measured.method = name(Method::paper_euler);
  measured.precision = "float32";
  const bool on_gpu = settings.device.name == "cuda";
  measured.bodies = on_gpu ? 1056 : settings.quick ? 2 : 32;
  measured.steps = settings.quick ? 200 : 1000;
  measured.runs = settings.quick ? 5 : 9;
  Table table("features", {"feature", "cost (% of the time without it)"});
  const bench::Report report = bench::feature_costs(measured);
  for (const auto& row : report.at("rows"))
    table.add({row.at("feature").get<std::string>(), row.at("cost_in_percent_of_time").get<double>()});
  return {table};
}

}  // namespace evodevo::tools::accuracy
