// Develops one genome in several scenes, and tests whether the bodies differ because of the scene or only because of
// perturbed starts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "environments/grown_body.hpp"
#include "environments/scene_effect.hpp"
#include "life/body_json.hpp"

namespace evodevo {

/// The development of the genome from one start.
struct Grown {
  Status status = Status::ok;
  std::string reason;            ///< reason of a status other than ok
  std::vector<GrownBody> after;  ///< the body after each cycle, until the life failed
  GivenBody matured = {};        ///< the body after the last cycle, unless the life failed
};

/// A scene, and the development in it from each start. The first start is not perturbed.
struct Environment {
  std::string name;
  double slope = 0;                    ///< degrees
  std::vector<std::string> materials;  ///< names of the materials
  std::vector<Grown> grown;            ///< one development for each start
};

/// A distance between two bodies.
struct BodyDistance {
  const char* name;
  const char* title;
  double (*distance)(const GrownBody&, const GrownBody&);
};

/// All distances: spring_distance() and mass_distance().
extern const std::vector<BodyDistance> body_distances;

/// The comparison of two scenes.
struct ScenePair {
  std::size_t a, b;  ///< indices into SceneStudy::environments
  /// effects[d][c]: difference of the bodies, measured by body_distances[d], after cycle c, counted from 0; none if all
  /// bodies of a scene had failed by then
  std::vector<std::vector<std::optional<SceneEffect>>> effects;
};

/// The development of one genome in all scenes.
struct SceneStudy {
  std::uint32_t individual;               ///< id of the individual
  std::vector<Environment> environments;  ///< one for each scene; Grown::after is empty
  std::vector<ScenePair> pairs;           ///< all pairs of scenes
};

/// Develops a newborn in the scene of each experiment, once from each of `starts` starts, and compares the bodies after
/// each of the first `cycles` cycles. All starts except the first are perturbed (perturb() in life/birth.hpp).
SceneStudy study_scenes(const std::vector<Experiment>& experiments, const Newborn& newborn, std::uint32_t starts,
                        std::size_t cycles);

}  // namespace evodevo
