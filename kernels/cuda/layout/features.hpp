// What is compiled into a kernel.
#pragma once

#include <compare>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "cuda/layout/formats.hpp"

namespace evodevo::cuda {

/// How a method steps bodies on the GPU.
struct MethodForm {
  const char* file;               ///< of an explicit method: what moves a mass; else the kernel of a whole body
  unsigned rows_per_step;         ///< rows of the tables of lengths that time advances by in a step
  unsigned end_rows;              ///< 1 where a step reads the row at its end, else 0
  unsigned opening_passes = 0;    ///< over the springs, before the first of some steps; of explicit methods
  unsigned passes_per_step = 0;   ///< likewise
  unsigned numbers_of_mass = 0;   ///< of scratch memory that a streamed body needs for each mass
  unsigned numbers_of_joint = 0;  ///< likewise for each joint
  unsigned points_on_chip = 0;    ///< of each mass, in shared memory where there is room, of methods of whole bodies
  bool coloured = false;          ///< whether it needs the springs by colour

  unsigned rows(unsigned steps) const { return steps * rows_per_step + end_rows; }
  /// Of so many steps, the first of which comes `since_check` steps after a check; after each check the first pass is
  /// an opening one again, as at the beginning.
  std::uint64_t passes(std::uint64_t steps, unsigned since_check = 0) const {
    return (since_check + steps + guard_interval - 1) / guard_interval * opening_passes + steps * passes_per_step;
  }
};

const MethodForm& form_of(Method method);

/// What of the scene and of a run is compiled into a kernel.
struct Features {
  Method method = Method::paper_euler;
  bool float64 = false;
  Materials materials = Materials::table;
  bool gravity = false, slope = false, floor = false, rough = false, friction = false, damping = false, drag = false;
  bool actuation = false, stress = false, work = false;
  bool peak_force = false, muscle_work = false, tension = false;  ///< muscle_work: only with work

  friend auto operator<=>(const Features&, const Features&) = default;
};

/// `actuation`: whether the body has a muscle among its materials.
Features features_of(const Scene& scene, const Stepping& stepping, Recording recording, bool actuation);

/// Whether springs on the chip carry codes of their materials. In double precision the codes' materials come from a
/// table all the same.
inline bool has_codes(const Features& features) {
  return features.materials == Materials::computed && !features.float64;
}

/// What of a body's layout is compiled into the kernel that keeps it on the chip.
struct ResidentForm {
  unsigned rows = 0, masses_per_thread = 0;
  bool chunked = false;          ///< more than one chunk of rows for each warp
  bool records_on_chip = false;  ///< springs in shared memory, else streamed from the device's
  bool wide_offsets = false;     ///< masses beyond the first 64 KiB
  bool wide_table = false;       ///< materials beyond the first 64 KiB of the table

  friend auto operator<=>(const ResidentForm&, const ResidentForm&) = default;
};

/// The largest block, in warps, that a resident kernel is compiled for: what the registers of a multiprocessor bear.
inline unsigned largest_block(bool float64) { return float64 ? 16 : 32; }

/// Threads of the kernel that checks streamed bodies.
inline constexpr unsigned check_threads = 512;

std::vector<std::string> definitions(const Features& features);
std::vector<std::string> definitions(const Features& features, const ResidentForm& form);

}  // namespace evodevo::cuda
