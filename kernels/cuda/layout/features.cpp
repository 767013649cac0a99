#include "cuda/layout/features.hpp"

#include <algorithm>

namespace evodevo::cuda {

namespace {

std::string number(const char* name, unsigned value) {
  return std::string("EVODEVO_") + name + "=" + std::to_string(value);
}

}  // namespace

const MethodForm& form_of(Method method) {
  static constexpr MethodForm forms[] = {
      {.file = "cuda/device/methods/paper_euler.cuh", .rows_per_step = 1, .end_rows = 0, .passes_per_step = 1},
      {.file = "cuda/device/methods/symplectic_euler.cuh", .rows_per_step = 1, .end_rows = 0, .passes_per_step = 1},
      {.file = "cuda/device/methods/velocity_verlet.cuh",
       .rows_per_step = 1,
       .end_rows = 1,
       .opening_passes = 1,
       .passes_per_step = 1,
       .numbers_of_mass = 1},
      {.file = "cuda/device/methods/rk4.cuh",
       .rows_per_step = 2,
       .end_rows = 1,
       .passes_per_step = 4,
       .numbers_of_mass = 13},
      {.file = "cuda/device/methods/implicit.cu",
       .rows_per_step = 1,
       .end_rows = 1,
       .numbers_of_mass = 24,
       .numbers_of_joint = 5,
       .points_on_chip = 3},
      {.file = "cuda/device/methods/xpbd.cu",
       .rows_per_step = 1,
       .end_rows = 1,
       .numbers_of_mass = 1,
       .points_on_chip = 2,
       .coloured = true}};
  return forms[static_cast<std::size_t>(method)];
}

MaterialFeatures material_features(const Body& body) {
  MaterialFeatures features;
  for (const Material& material : body.materials) {
    features.actuation = features.actuation || material.amplitude != 0;
    features.dashpots = features.dashpots || material.damping != 0;
  }
  return features;
}

Features features_of(const Scene& scene, const Stepping& stepping, Recording recording, MaterialFeatures materials,
                     const Channels& channels) {
  return {.method = stepping.method,
          .float64 = stepping.precision == Precision::float64,
          .materials = stepping.materials,
          .gravity = scene.gravity.has_value(),
          .slope = scene.on_slope(),
          .has_floor = scene.floor.has_value(),
          .elastic_floor = scene.floor && !scene.floor->rigid(),
          .rigid_floor = scene.floor && scene.floor->rigid(),
          .rough = scene.floor && scene.floor->rough(),
          .friction = scene.friction && scene.floor,
          .static_friction = scene.friction && scene.floor && scene.friction->higher_at_rest(),
          .damping = scene.damping.has_value(),
          .drag = scene.drag.has_value(),
          .actuation = materials.actuation,
          .dashpots = materials.dashpots,
          .stress = recording.stress,
          .work = recording.work || recording.muscle_work || channels.work,
          .peak_force = recording.peak_force,
          .muscle_work = recording.muscle_work,
          .mean_tension = recording.tension,
          .sampled = channels.any(),
          .contacts = channels.contact || channels.contacts};
}

std::vector<std::string> definitions(const Features& features) {
  const MethodForm& method = form_of(features.method);
  std::vector<std::string> all{features.float64 ? "EVODEVO_NUMBER=double" : "EVODEVO_NUMBER=float",
                               "EVODEVO_METHOD=\"" + std::string(method.file) + "\"",
                               number("ROWS_PER_STEP", method.rows_per_step),
                               number("END_ROWS", method.end_rows),
                               number("OPENING_PASSES", method.opening_passes),
                               number("PASSES_PER_STEP", method.passes_per_step),
                               number("NUMBERS_OF_MASS", method.numbers_of_mass),
                               number("NUMBERS_OF_JOINT", method.numbers_of_joint),
                               number("MAX_THREADS", 32 * largest_block(features.float64)),
                               number("CHECK_THREADS", check_threads)};
#define EVODEVO_DEFINE(name, whole) \
  all.push_back(std::string("EVODEVO_HAS_" #name "=") + (features.name ? "true" : "false"));
  EVODEVO_FEATURES(EVODEVO_DEFINE)
#undef EVODEVO_DEFINE
  return all;
}

std::vector<std::string> definitions(const Features& features, const ResidentForm& form) {
  std::vector<std::string> all = definitions(features);
  all.push_back("EVODEVO_MATERIALS=\"cuda/device/materials/" + std::string(has_codes(features) ? "computed" : "table") +
                ".cuh\"");
  all.push_back(number("ROWS", form.rows));
  all.push_back(number("MASSES", form.masses_per_thread));
  all.push_back(number("CHUNKED", form.chunked));
  all.push_back(number("RECORDS_ON_CHIP", form.records_on_chip));
  all.push_back(number("CLUSTERED", form.clustered));
  const unsigned shift = features.float64 ? 3 : 2;  // from numbers to bytes
  all.push_back(number("OFFSET_SHIFT", form.wide_offsets ? shift : 0));
  all.push_back(number("ENTRY_SHIFT", form.wide_table ? shift : 0));
  return all;
}

}  // namespace evodevo::cuda
