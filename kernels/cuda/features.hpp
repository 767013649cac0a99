// What is compiled into a kernel.
#pragma once

#include <compare>
#include <string>
#include <vector>

#include "scene.hpp"
#include "simulator.hpp"

namespace evodevo::cuda {

/// What of the scene and of a run is compiled into a kernel.
struct Features {
  bool float64 = false;
  bool gravity = false, floor = false, friction = false, damping = false, drag = false;
  bool actuation = false, stress = false, work = false;

  friend auto operator<=>(const Features&, const Features&) = default;
};

/// `actuation`: whether some body has a muscle among its materials.
Features features_of(const Scene& scene, Precision precision, Recording recording, bool actuation);

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
