// Which features are compiled into a kernel.
#pragma once

#include <compare>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "cuda/layout/feature_list.hpp"
#include "cuda/layout/formats.hpp"

namespace evodevo::cuda {

/// How a method computes steps on the GPU.
struct MethodForm {
  const char* file;        ///< explicit methods: code that moves a mass; other methods: kernel that simulates a body
  unsigned rows_per_step;  ///< rows of the tables of lengths per step
  unsigned end_rows;       ///< 1 if a step reads the row at its end, otherwise 0
  unsigned opening_passes = 0;    ///< explicit methods: passes over the springs before the first step after a check
  unsigned passes_per_step = 0;   ///< explicit methods: passes over the springs in each step
  unsigned numbers_of_mass = 0;   ///< scratch memory of a streamed body, numbers per mass
  unsigned numbers_of_joint = 0;  ///< scratch memory of a streamed body, numbers per joint
  unsigned points_on_chip = 0;    ///< other methods: points per mass in shared memory, if there is room
  bool coloured = false;          ///< whether the method needs the springs by colour

  /// Rows of the tables for `steps` steps.
  unsigned rows(unsigned steps) const { return steps * rows_per_step + end_rows; }
  /// Passes over the springs in `steps` steps, the first of which comes `since_check` steps after a check. The opening
  /// passes come at the beginning and after every check.
  std::uint64_t passes(std::uint64_t steps, unsigned since_check = 0) const {
    return (since_check + steps + guard_interval - 1) / guard_interval * opening_passes + steps * passes_per_step;
  }
};

const MethodForm& form_of(Method method);

/// Features of the scene and of a run that are compiled into a kernel (feature_list.hpp).
struct Features {
  Method method = Method::paper_euler;
  bool float64 = false;
  Materials materials = Materials::table;
#define EVODEVO_MEMBER(name, whole) bool name = false;
  EVODEVO_FEATURES(EVODEVO_MEMBER)
#undef EVODEVO_MEMBER

  friend auto operator<=>(const Features&, const Features&) = default;
};

/// What a body's materials ask for.
struct MaterialFeatures {
  bool actuation = false;  ///< a material is that of a muscle
  bool dashpots = false;   ///< a material has a damping ratio
};

MaterialFeatures material_features(const Body& body);

/// The features for a scene, a body and a run. `channels` are those of any sample that the device takes.
Features features_of(const Scene& scene, const Stepping& stepping, Recording recording, MaterialFeatures materials,
                     const Channels& channels = {});

/// Whether springs on the chip carry codes of their materials. In double precision, they do not: the rounded materials
/// come from a table.
inline bool has_codes(const Features& features) {
  return features.materials == Materials::computed && !features.float64;
}

/// Whether dashpots act at velocities that the method has predicted (Course::dashpot_velocity).
inline bool predicts_dashpot_velocities(const Features& features) {
  return features.dashpots && features.method == Method::velocity_verlet;
}

/// Features of a body's layout that are compiled into the kernel that keeps it on the chip.
struct ResidentForm {
  unsigned rows = 0;  ///< rows that are unrolled: springs of a thread
  unsigned masses_per_thread = 0;
  bool chunked = false;          ///< warps have more than one chunk of rows
  bool records_on_chip = false;  ///< springs in shared memory; otherwise streamed from the device's memory
  bool wide_offsets = false;  ///< offsets of masses count numbers, because in bytes they would need more than 16 bits
  bool wide_table = false;    ///< likewise for offsets of the table's entries
  bool clustered = false;     ///< a cluster of blocks simulates the body

  friend auto operator<=>(const ResidentForm&, const ResidentForm&) = default;
};

/// The largest block, in warps, for which a resident kernel is compiled; the registers of a multiprocessor limit it.
inline unsigned largest_block(bool float64) { return float64 ? 16 : 32; }

/// Threads of the kernel that checks streamed bodies.
inline constexpr unsigned check_threads = 512;

/// The macro definitions for the compiler, such as "EVODEVO_STRESS=true".
std::vector<std::string> definitions(const Features& features);
std::vector<std::string> definitions(const Features& features, const ResidentForm& form);

}  // namespace evodevo::cuda
