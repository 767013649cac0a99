#include "cuda/layout/arrangement/partition.hpp"

#include <algorithm>
#include <numeric>
#include <span>

#include "evodevo/body.hpp"

namespace evodevo::cuda {
namespace {

/// Divides masses into parts by planes, one plane at a time (recursive bisection).
class Bisection {
 public:
  explicit Bisection(const Outline& body) : body_(body), load_(body.rest.size(), 1), part_(body.rest.size()) {
    for (const auto& [a, b] : body.ends) ++load_[a], ++load_[b];
  }

  std::vector<std::uint32_t> parts(unsigned count) {
    std::vector<std::uint32_t> masses(load_.size());
    std::iota(masses.begin(), masses.end(), 0u);
    divide(masses, 0, count);
    return std::move(part_);
  }

 private:
  using Masses = std::span<std::uint32_t>;

  void divide(Masses masses, unsigned first, unsigned count) {
    if (count == 1) {
      for (const std::uint32_t mass : masses) part_[mass] = first;
      return;
    }
    const double Vec3::*const axis = longest_side(masses);
    std::ranges::sort(masses, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(body_.rest[a].*axis, a) < std::pair(body_.rest[b].*axis, b);
    });
    const unsigned below = count / 2;
    const Masses lower = masses.first(masses_below(masses, below, count));
    divide(lower, first, below);
    divide(masses.subspan(lower.size()), first + below, count - below);
  }

  const double Vec3::*longest_side(Masses masses) const {
    const double Vec3::*longest = &Vec3::x;
    double length = -1;
    for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      const auto of = [&](std::uint32_t mass) { return body_.rest[mass].*axis; };
      const auto [low, high] = std::ranges::minmax_element(masses, {}, of);
      if (low == masses.end() || of(*high) - of(*low) <= length) continue;
      length = of(*high) - of(*low);
      longest = axis;
    }
    return longest;
  }

  /// The number of these masses, from the first on, that have `below` of `count` shares of their load, if that leaves a
  /// mass for each part.
  std::size_t masses_below(Masses masses, unsigned below, unsigned count) const {
    std::size_t total = 0, sum = 0, number = 0;
    for (const std::uint32_t mass : masses) total += load_[mass];
    while (number < masses.size() && sum * count < total * below) sum += load_[masses[number++]];
    return std::clamp<std::size_t>(number, below, masses.size() - (count - below));
  }

  const Outline& body_;
  std::vector<std::uint32_t> load_;  ///< [masses] of the body
  std::vector<std::uint32_t> part_;  ///< [masses]
};

/// The index of each mass in the halo of a part.
class HaloIndex {
 public:
  explicit HaloIndex(std::size_t masses) : index_(masses, absent) {}

  /// The index of a mass in the halo of `part`, to which it is added if need be.
  std::uint32_t of(std::uint32_t mass, Part& part) {
    if (index_[mass] == absent) {
      index_[mass] = part.outline.halo++;
      part.masses.push_back(mass);
    }
    return index_[mass];
  }
  void clear(const Part& part) {
    for (const std::uint32_t mass : part.masses) index_[mass] = absent;
  }

 private:
  static constexpr std::uint32_t absent = 0xffffffff;
  std::vector<std::uint32_t> index_;
};

}  // namespace

std::vector<std::uint32_t> parts_of_masses(const Outline& body, unsigned parts) { return Bisection(body).parts(parts); }

std::vector<Part> partition(const Outline& body, unsigned count) {
  const std::vector<std::uint32_t> part_of = parts_of_masses(body, count);
  std::vector<Part> parts(count);
  std::vector<std::uint32_t> local(part_of.size());
  for (std::uint32_t mass = 0; mass < part_of.size(); ++mass) {
    Part& part = parts[part_of[mass]];
    local[mass] = static_cast<std::uint32_t>(part.masses.size());
    part.masses.push_back(mass);
    part.outline.rest.push_back(body.rest[mass]);
  }
  std::vector<std::vector<std::uint32_t>> cut(parts.size());  // springs
  for (std::uint32_t i = 0; i < body.ends.size(); ++i) {
    const auto [a, b] = body.ends[i];
    if (part_of[a] == part_of[b]) {
      parts[part_of[a]].outline.ends.emplace_back(local[a], local[b]);
      parts[part_of[a]].springs.push_back(i);
    } else {
      cut[part_of[a]].push_back(i);
      cut[part_of[b]].push_back(i);
    }
  }
  HaloIndex halo(part_of.size());
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    Part& part = parts[p];
    for (const std::uint32_t i : cut[p]) {
      auto [own, other] = body.ends[i];
      if (part_of[own] != p) std::swap(own, other);
      part.outline.cut.emplace_back(local[own], halo.of(other, part));
      part.springs.push_back(i);
    }
    halo.clear(part);
  }
  return parts;
}

}  // namespace evodevo::cuda
