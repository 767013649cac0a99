// Whether the scene decides what a genome grows into, or the noise of the start.
#pragma once

#include <optional>
#include <vector>

namespace evodevo {

/// How far the bodies of two scenes are apart.
struct SceneEffect {
  double between = 0;            ///< mean distance of a body of one scene from one of the other
  std::optional<double> within;  ///< of two bodies of one scene, mean of both scenes; none unless both have two bodies
  std::optional<double> p;       ///< how often bodies dealt out at random to the scenes are as far apart or further
};

/// `distances[i][j]`, i < j, is that of two bodies; the first `first` of them are those of one scene, and each scene
/// has at least one. Further apart is where `between` is more above `within` (the energy statistic of Székely and Rizzo
/// 2004). p is that of a permutation test by 9,999 deals, the given one counted in, which are the same at every call.
SceneEffect scene_effect(const std::vector<std::vector<double>>& distances, std::size_t first);

}  // namespace evodevo
