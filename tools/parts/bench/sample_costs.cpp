#include <cmath>
#include <string>
#include <vector>

#include "batch.hpp"
#include "studies.hpp"

namespace evodevo::tools::bench {
namespace {

/// Samples that are taken at a constant rate. `recording` is recorded in the runs with and without them.
struct Sampled {
  std::string channels_of_samples;
  Channels channels;
  double rate;  ///< Hz
  std::string recorded;
  Recording recording;
};

std::vector<Sampled> kinds() {
  const Channels reduced{.centre = true, .box = true, .contact = true};
  Channels with_work = reduced;
  with_work.work = true;
  return {{"centre, box, contact, work", with_work, 100, "work", {.work = true}},
          {"centre, box, contact", reduced, 100, "", {}},
          {"contact of each mass", {.contacts = true}, 100, "", {}},
          {"position of each mass", {.positions = true}, 30, "", {}}};
}

std::vector<SamplePoint> points(const Sampled& sampled, std::uint64_t steps) {
  std::vector<SamplePoint> all;
  for (std::uint64_t i = 0;; ++i) {
    const auto step = static_cast<std::uint64_t>(std::llround(static_cast<double>(i) / (sampled.rate * time_step)));
    if (step > steps) return all;
    all.push_back({step, sampled.channels});
  }
}

}  // namespace

Report sample_costs(const Settings& settings) {
  const NamedBody body = body_named(settings.body, settings.masses, settings.materials);
  Batch batch(settings, {&body.body, 1}, walking_scene());
  Report rows = Report::array();
  for (const Sampled& sampled : kinds()) {
    const std::vector<SamplePoint> sampled_at = points(sampled, settings.steps);
    std::vector<double> with, without, ratios, of_steps;
    for (int run = 0; run <= settings.runs; ++run) {
      const Rate plain = batch.rate(sampled.recording), rate = batch.rate(sampled.recording, sampled_at);
      if (run == 0) continue;  // warm-up
      without.push_back(plain.whole);
      with.push_back(rate.whole);
      ratios.push_back(rate.whole / plain.whole);
      of_steps.push_back(rate.device / plain.device);
    }
    rows.push_back({{"samples", sampled.channels_of_samples},
                    {"hz", sampled.rate},
                    {"recorded", sampled.recorded},
                    {"rate_with_samples", median(with)},
                    {"rate_without", median(without)},
                    {"ratio", median(ratios)},
                    {"ratio_of_steps_alone", median(of_steps)}});
  }
  Report report = conditions(settings, "What samples cost", batch.device(), body);
  report["note"] =
      "Rates are medians of spring evaluations per second, for whole runs, at whose end the samples are in the host's "
      "memory; a ratio is the median of the ratios within each run. What is recorded is recorded with and without "
      "samples.";
  report["rows"] = std::move(rows);
  return report;
}

}  // namespace evodevo::tools::bench
