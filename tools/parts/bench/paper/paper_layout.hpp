// All bodies in the paper's buffers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/scene.hpp"
#include "evodevo/body.hpp"
#include "paper/formats.hpp"
#include "paper/spring_order.hpp"

namespace evodevo::tools::bench {

/// Bodies at birth as the device gets them.
struct PaperLayout {
  /// `copies` of each body, those of one behind each other; springs in `order`.
  PaperLayout(std::span<const Body> bodies, std::uint32_t copies, const Scene& scene, SpringOrder order);

  std::vector<PaperBody> bodies;
  std::vector<PaperSpring> springs;
  std::vector<float> mass, inverse_mass;            ///< kg, 1/kg
  std::vector<cuda::Point<float>> positions;        ///< m
  std::vector<cuda::Actuator> actuators;            ///< of all bodies' materials
  std::uint32_t most_masses = 0, most_springs = 0;  ///< of a body

 private:
  void append(const Body& body, const State& birth, std::span<const std::uint32_t> order, std::uint32_t first_entry);
};

}  // namespace evodevo::tools::bench
