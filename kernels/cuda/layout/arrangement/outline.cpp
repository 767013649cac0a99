#include "cuda/layout/arrangement/outline.hpp"

#include <algorithm>

namespace evodevo::cuda {

Outline::Outline(const Body& body) {
  rest.reserve(body.masses.size());
  for (const Mass& mass : body.masses) rest.push_back(mass.rest);
  ends.reserve(body.springs.size());
  for (const Spring& spring : body.springs) ends.emplace_back(spring.a, spring.b);
}

bool Outline::fits(const Body& body) const {
  return body.masses.size() == rest.size() &&
         std::equal(body.springs.begin(), body.springs.end(), ends.begin(), ends.end(),
                    [](const Spring& spring, const auto& pair) { return std::pair(spring.a, spring.b) == pair; });
}

}  // namespace evodevo::cuda
