#include <string>
#include <vector>

#include "batch.hpp"
#ifdef EVODEVO_CUDA
#include "cuda/layout/features.hpp"
#include "cuda/runtime/compiler.hpp"
#include "machine_code.hpp"
#endif
#include "studies.hpp"

namespace evodevo::tools::bench {
namespace {

/// A body in a scene, and the quantities that are recorded.
struct Variant {
  const Body* body;
  Scene scene;
  Recording recording;
};

/// A feature, with two variants that differ only in it.
struct Feature {
  std::string name;
  Variant with, without;
};

/// For each feature of the walking scene, the scene with and without it; for each feature that the scene lacks, the
/// scene with it added and as it is.
std::vector<Feature> features(const Body& body, const Body& still_body, const Body& damped_body) {
  const auto walking = [&](auto... changes) {
    Variant variant{&body, walking_scene(), {}};
    (changes(variant), ...);
    return variant;
  };
  const auto no_friction = [](Variant& v) { v.scene.friction.reset(); };
  const auto no_floor = [](Variant& v) { v.scene.floor.reset(); };
  const auto dashpots = [&](Variant& v) { v.body = &damped_body; };
  const auto stress = [](Variant& v) { v.recording.stress = true; };
  return {
      {"gravity", walking(), walking([](Variant& v) { v.scene.gravity.reset(); })},
      // without a floor there is no friction, so both variants leave friction out
      {"floor", walking(no_friction), walking(no_friction, no_floor)},
      {"friction", walking(), walking(no_friction)},
      {"damping", walking(), walking([](Variant& v) { v.scene.damping.reset(); })},
      {"drag", walking([](Variant& v) { v.scene.drag = Drag{}; }), walking()},
      {"actuation", walking(), walking([&](Variant& v) { v.body = &still_body; })},
      {"dashpots", walking(dashpots), walking()},
      {"dashpots, with stress", walking(dashpots, stress), walking(stress)},
      {"stress", walking(stress), walking()},
      {"work", walking([](Variant& v) { v.recording.work = true; }), walking()},
  };
}

/// Adds to a row what the feature adds to the instructions of the kernel that keeps a body on the chip, for Hopper.
void add_instructions([[maybe_unused]] const Feature& feature, [[maybe_unused]] Report& row) {
#ifdef EVODEVO_CUDA
  const auto code = [](const Variant& variant) {
    const cuda::Features features =
        cuda::features_of(variant.scene, {}, variant.recording, cuda::material_features(*variant.body));
    const cuda::ResidentForm form{.rows = cuda::most_rows, .masses_per_thread = 1, .records_on_chip = true};
    return machine_code(cuda::compile("cuda/device/resident.cu", definitions(features, form), "sm_90"))
        .at("evodevo_run_resident");
  };
  const MachineCode with = code(feature.with), without = code(feature.without);
  row["instructions_with_it"] = with.instructions;
  row["instructions_without_it"] = without.instructions;
  row["local_accesses_with_it"] = with.local_accesses;
  row["local_accesses_without_it"] = without.local_accesses;
#endif
}

/// Measures the rates with and without a feature alternately.
class Comparison {
 public:
  Comparison(const Settings& settings, const Feature& feature)
      : feature_(feature),
        with_(settings, {feature.with.body, 1}, feature.with.scene),
        without_(settings, {feature.without.body, 1}, feature.without.scene) {
    measure();  // warm-up
    for (std::vector<double>* values : {&rates_with_, &rates_without_, &ratios_}) values->clear();
  }

  std::string device() const { return with_.device(); }

  void measure() {
    rates_with_.push_back(with_.rate(feature_.with.recording).device);
    rates_without_.push_back(without_.rate(feature_.without.recording).device);
    ratios_.push_back(rates_with_.back() / rates_without_.back());
  }

  Report row() const {
    return {{"feature", feature_.name},
            {"rate_with_it", median(rates_with_)},
            {"rate_without_it", median(rates_without_)},
            {"ratio", median(ratios_)},
            {"cost_in_percent_of_time", 100 * (1 / median(ratios_) - 1)}};
  }

 private:
  const Feature& feature_;
  Batch with_, without_;
  std::vector<double> rates_with_, rates_without_, ratios_;
};

}  // namespace

Report feature_costs(const Settings& settings) {
  const NamedBody body = body_named(settings.body, settings.masses, settings.materials);
  const Body still_body = without_actuation(body.body);
  Body damped_body = body.body;
  for (Material& material : damped_body.materials) material.damping = 0.3;
  Report rows = Report::array();
  std::string device;
  for (const Feature& feature : features(body.body, still_body, damped_body)) {
    Comparison comparison(settings, feature);
    for (int run = 0; run < settings.runs; ++run) comparison.measure();
    rows.push_back(comparison.row());
    if (settings.device == "cuda") add_instructions(feature, rows.back());
    device = comparison.device();
  }
  Report report = conditions(settings, "What each feature costs", device, body);
  report["note"] =
      "Rates are medians of spring evaluations per second, for the time steps alone; a cost is the median of the "
      "ratios "
      "within each run. The rest of the scene is unchanged, except that the floor is compared without friction, and "
      "drag is 1 kg/m.";
  report["rows"] = std::move(rows);
  return report;
}

}  // namespace evodevo::tools::bench
