#include "cuda/features.hpp"

namespace evodevo::cuda {

Features features_of(const Scene& scene, Precision precision, Recording recording, bool actuation) {
  return {.float64 = precision == Precision::float64,
          .gravity = scene.gravity.has_value(),
          .floor = scene.floor.has_value(),
          .friction = scene.friction && scene.floor,
          .damping = scene.damping.has_value(),
          .drag = scene.drag.has_value(),
          .actuation = actuation,
          .stress = recording.stress,
          .work = recording.work};
}

std::vector<std::string> definitions(const Features& features) {
  const auto flag = [](const char* name, bool on) {
    return std::string("EVODEVO_") + name + "=" + (on ? "true" : "false");
  };
  return {features.float64 ? "EVODEVO_NUMBER=double" : "EVODEVO_NUMBER=float",
          "EVODEVO_CHECK_THREADS=" + std::to_string(check_threads),
          flag("ACTUATION", features.actuation),
          flag("GRAVITY", features.gravity),
          flag("FLOOR", features.floor),
          flag("FRICTION", features.friction),
          flag("DAMPING", features.damping),
          flag("DRAG", features.drag),
          flag("STRESS", features.stress),
          flag("WORK", features.work)};
}

std::vector<std::string> definitions(const Features& features, const ResidentForm& form) {
  const auto number = [](const char* name, unsigned value) {
    return std::string("EVODEVO_") + name + "=" + std::to_string(value);
  };
  std::vector<std::string> all = definitions(features);
  all.push_back(number("ROWS", form.rows));
  all.push_back(number("MASSES", form.masses_per_thread));
  all.push_back(number("CHUNKED", form.chunked));
  all.push_back(number("RECORDS_ON_CHIP", form.records_on_chip));
  const unsigned shift = features.float64 ? 3 : 2;  // from numbers to bytes
  all.push_back(number("OFFSET_SHIFT", form.wide_offsets ? shift : 0));
  all.push_back(number("ENTRY_SHIFT", form.wide_table ? shift : 0));
  all.push_back(number("MAX_THREADS", 32 * largest_block(features.float64)));
  return all;
}

}  // namespace evodevo::cuda
