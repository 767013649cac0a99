// One genome in several scenes: what it grows into, and whether the scene or the noise of the start decides that.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "environments/grown_body.hpp"
#include "environments/scene_effect.hpp"
#include "life/body_json.hpp"

namespace evodevo {

/// What became of the genome after one start.
struct Grown {
  Status status = Status::ok;
  std::string reason;
  std::vector<GrownBody> after;  ///< each cycle that it lived through
  GivenBody matured = {};        ///< unless it failed
};

/// A scene and what grew in it from each start, the first without noise.
struct Environment {
  std::string name;
  double slope = 0;  ///< degrees
  std::vector<std::string> materials;
  std::vector<Grown> grown;
};

/// A measure of how far two bodies are apart.
struct BodyDistance {
  const char* name;
  const char* title;
  double (*distance)(const GrownBody&, const GrownBody&);
};

/// All measures: by springs, and by mass.
extern const std::vector<BodyDistance> body_distances;

/// Two scenes, and how far apart the bodies are that grew in them after each cycle, by each of body_distances; none
/// where a scene has no body left.
struct ScenePair {
  std::size_t a, b;
  std::vector<std::vector<std::optional<SceneEffect>>> effects;
};

/// One genome in all scenes.
struct SceneStudy {
  std::uint32_t individual;               ///< id
  std::vector<Environment> environments;  ///< their Grown::after are empty
  std::vector<ScenePair> pairs;           ///< every two scenes
};

/// Lets a newborn develop in the scene of each experiment from `starts` starts, of which all but the
/// first are perturbed (perturbation.hpp), and compares the bodies after each of the first `cycles` cycles.
SceneStudy study_scenes(const std::vector<Experiment>& experiments, const Newborn& newborn, std::uint32_t starts,
                        std::size_t cycles);

}  // namespace evodevo
