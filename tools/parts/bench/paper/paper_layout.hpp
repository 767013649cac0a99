// The buffers of the paper's methods, filled with all bodies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/scene.hpp"
#include "evodevo/body.hpp"
#include "paper/formats.hpp"
#include "paper/spring_order.hpp"

namespace evodevo::tools::bench {

/// Bodies at birth, in the format in which they are copied to the device.
struct PaperLayout {
  /// Lays out `copies` of each body, the copies of one body next to each other, with springs in `order`.
  PaperLayout(std::span<const Body> bodies, std::uint32_t copies, const Scene& scene, SpringOrder order);

  std::vector<PaperBody> bodies;
  std::vector<PaperSpring> springs;
  std::vector<float> mass, inverse_mass;            ///< kg, 1/kg
  std::vector<cuda::Point<float>> positions;        ///< m
  std::vector<cuda::Actuator> actuators;            ///< materials of all bodies
  std::uint32_t most_masses = 0, most_springs = 0;  ///< largest numbers in any body

 private:
  void append(const Body& body, const State& birth, std::span<const std::uint32_t> order, std::uint32_t first_entry);
};

}  // namespace evodevo::tools::bench
