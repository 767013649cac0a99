// Upper bounds of the frequencies of a body, which cost much less than the frequencies (analysis/stability.hpp).
#pragma once

#include <span>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// What springs resist with: their stiffness, the coefficient of their dashpot, or a sum of both.
struct Resistance {
  double of_length = 1;  ///< factor of the stiffness k, N/m
  double of_rate = 0;    ///< factor of the dashpot's coefficient c, N s/m

  double operator()(const Body& body, const Spring& spring) const {
    return of_length * body.stiffness(spring) + (of_rate != 0 ? of_rate * body.damping(spring) : 0);
  }
};

/// Upper bounds of the largest eigenvalue of the mass-weighted matrix M^-1/2 K M^-1/2 of a body, 1/s^2; K is the sum of
/// k e e^T over the springs, with k the resistance and e the direction of a spring.
class StiffnessBounds {
 public:
  /// `positions`: of the masses, m. The body and they must outlive this object.
  StiffnessBounds(const Body& body, std::span<const Vec3> positions, Resistance resistance);

  /// The cheapest, by Gershgorin discs on blocks of one mass: the largest 2 sum(k)/m. NaN if a position is not finite.
  double of_discs() const;

  /// A smaller one. Because |xb - xa|^2 <= 2 |xa|^2 + 2 |xb|^2, the matrix is at most twice its diagonal blocks. The
  /// bound is therefore twice the largest eigenvalue of the block of any mass. That of the discs is larger because it
  /// ignores that springs have different directions. NaN if that of a moving mass with springs is not finite.
  double of_blocks() const;

  /// Whether of_blocks() is below a positive `limit`, which takes less time to find out than the bound.
  bool blocks_are_below(double limit) const;

 private:
  struct Block;
  std::vector<Block> blocks_of_masses() const;

  const Body& body_;
  std::span<const Vec3> positions_;
  std::vector<double> resistance_;  ///< of each spring, N/m
};

}  // namespace evodevo
