// Tests whether bodies of one genome differ because of the scene or only because of perturbed starts.
#pragma once

#include <optional>
#include <vector>

namespace evodevo {

/// How different the bodies of two scenes are.
struct SceneEffect {
  double between = 0;  ///< mean distance between a body of one scene and a body of the other
  std::optional<double>
      within;               ///< mean distance within a scene, averaged over both; none if a scene has only one body
  std::optional<double> p;  ///< p-value of a permutation test; none if a scene has only one body
};

/// Compares the bodies of two scenes. `distances[i][j]`, i < j, is the distance between bodies i and j. The first
/// `first` bodies belong to one scene, the others to the other scene; each scene has at least one body. The test
/// statistic is `between` - `within` (the energy statistic of Székely and Rizzo 2004). The permutation test assigns
/// bodies to scenes at random 9,999 times, and p is the fraction of assignments whose statistic is at least as large as
/// that of the actual assignment, which counts as one of them. The random assignments are the same in every call.
SceneEffect scene_effect(const std::vector<std::vector<double>>& distances, std::size_t first);

}  // namespace evodevo
