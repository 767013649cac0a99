// How diverse the individuals of a run are: the map of their niches, and what selection has noted about the living.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "archive/archive.hpp"

namespace evodevo {

/// The best individual of a niche.
struct Elite {
  std::vector<std::uint32_t> cell;  ///< index along each axis of the map, from 0
  std::uint32_t individual = 0;     ///< id
  double score = 0;                 ///< first objective
};

/// What a map held after a generation.
struct MapState {
  std::size_t filled = 0;  ///< number of cells with an elite
  double sum = 0;          ///< of those first objectives of the elites that are positive
};

/// The niches of a run: a grid over the ranges of the first two descriptors, or of the only one, each divided into
/// Objective::bins. Every individual without failure that the run has ever had lies in a cell, whatever the selection
/// operator, and the best by the first objective is the elite of its cell, the eldest of several. Thus runs with
/// different selection operators have comparable maps (Pugh, Soros and Stanley 2016).
struct NicheMap {
  Objective objective;            ///< the first one of the run
  std::vector<Objective> axes;    ///< one or two descriptors; none if the run has none
  std::vector<Elite> elites;      ///< in the order of cells, the last axis fastest
  std::vector<MapState> history;  ///< after each generation

  std::size_t cells() const;
  /// Returns the share of cells that have an elite after a generation.
  double coverage(const MapState& state) const;
  /// Returns the QD score after a generation: the sum of the elites' first objectives, of which negative ones count as
  /// 0, so that it never falls. There is none for an objective to be minimised, because each further elite would make
  /// the sum worse.
  std::optional<double> qd_score(const MapState& state) const;
};

/// Returns the map of a run; without axes if the run has no descriptors.
NicheMap niche_map(const Archive& archive);

/// Returns the ids of the `count` elites with the best scores, best first.
std::vector<std::uint32_t> best_elites(const NicheMap& map, std::size_t count);

/// Returns the map as JSON without its history, or null if it has no axes.
nlohmann::ordered_json map_json(const NicheMap& map);
/// Returns a state of a map as JSON: the number of filled cells, coverage and QD score.
nlohmann::ordered_json state_json(const NicheMap& map, const MapState& state);

/// Returns what selection may note, as JSON.
nlohmann::ordered_json note_titles_json(const std::vector<NoteHistory>& histories);
/// Returns the notes about those who lived after a generation: the number of groups for labels, the greatest number and
/// the median for others, by title. Titles of which nobody had a note are left out.
nlohmann::ordered_json notes_json(const std::vector<NoteHistory>& histories, std::size_t generation);

/// Returns how many of the living had each label after each generation. Of each title, these are the `most` labels that
/// had the most members over the whole run, and the sum over all others. Titles are left out if all individuals have
/// labels of their own.
nlohmann::ordered_json labels_json(const std::vector<NoteHistory>& histories, std::size_t most = 12);

}  // namespace evodevo
