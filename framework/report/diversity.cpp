#include "report/diversity.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "base/statistics.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

bool is_better(double score, double other, const Objective& objective) {
  return objective.maximise ? score > other : score < other;
}

/// Returns the labels that are shown one by one: the `most` with the most members over the whole run, of several with
/// equally many those that came up first. They are in the order in which they came up.
std::vector<double> greatest_labels(const NoteHistory& history, std::size_t most) {
  struct Group {
    double label;
    std::size_t members = 0;
  };
  std::vector<Group> groups;
  std::map<double, std::size_t> index;  // into groups, by label
  for (const std::vector<double>& living : history.living)
    for (const double label : living) {
      const auto [found, is_new] = index.emplace(label, groups.size());
      if (is_new) groups.push_back({label});
      ++groups[found->second].members;
    }
  std::ranges::stable_sort(groups, std::greater(), &Group::members);
  groups.resize(std::min(groups.size(), most));
  std::ranges::sort(groups, {}, [&](const Group& group) { return index.at(group.label); });
  std::vector<double> labels;
  for (const Group& group : groups) labels.push_back(group.label);
  return labels;
}

/// Returns whether two of the living ever had the same label.
bool is_shared(const NoteHistory& history) {
  return std::ranges::any_of(history.living, [](const std::vector<double>& living) {
    return std::set(living.begin(), living.end()).size() < living.size();
  });
}

}  // namespace

std::size_t NicheMap::cells() const {
  return std::accumulate(axes.begin(), axes.end(), std::size_t{1},
                         [](std::size_t product, const Objective& axis) { return product * axis.bins; });
}

double NicheMap::coverage(const MapState& state) const {
  return static_cast<double>(state.filled) / static_cast<double>(cells());
}

std::optional<double> NicheMap::qd_score(const MapState& state) const {
  return objective.maximise ? std::optional(state.sum) : std::nullopt;
}

namespace {

/// What an elite adds to the QD score.
double credit(double score) { return std::max(score, 0.0); }

}  // namespace

NicheMap niche_map(const Archive& archive) {
  NicheMap map{archive.objectives().front(), archive.descriptors(), {}, {}};
  map.axes.resize(std::min<std::size_t>(map.axes.size(), 2));
  if (map.axes.empty()) return map;
  const std::vector<Described> everyone = archive.described(map.axes.size());
  std::map<std::vector<std::uint32_t>, Elite> elites;
  MapState state;
  auto next = everyone.begin();
  for (const Summary& summary : archive.generations()) {
    for (; next != everyone.end() && next->born <= summary.generation; ++next) {
      std::vector<std::uint32_t> cell;
      for (std::size_t axis = 0; axis < map.axes.size(); ++axis)
        cell.push_back(map.axes[axis].bin(next->descriptors[axis]));
      const auto [found, is_new] = elites.emplace(cell, Elite{cell, next->id, next->score});
      Elite& elite = found->second;
      state.filled += is_new;
      if (is_new) state.sum += credit(elite.score);
      if (!is_better(next->score, elite.score, map.objective)) continue;
      state.sum += credit(next->score) - credit(elite.score);
      elite = {cell, next->id, next->score};
    }
    map.history.push_back(state);
  }
  for (auto& [cell, elite] : elites) map.elites.push_back(std::move(elite));
  return map;
}

std::vector<std::uint32_t> best_elites(const NicheMap& map, std::size_t count) {
  std::vector<Elite> elites = map.elites;
  std::ranges::stable_sort(elites,
                           [&](const Elite& a, const Elite& b) { return is_better(a.score, b.score, map.objective); });
  std::vector<std::uint32_t> ids;
  for (const Elite& elite : elites) ids.push_back(elite.individual);
  ids.resize(std::min(ids.size(), count));
  return ids;
}

Json map_json(const NicheMap& map) {
  if (map.axes.empty()) return nullptr;
  Json axes = Json::array(), elites = Json::array();
  for (const Objective& axis : map.axes)
    axes.push_back(
        {{"name", axis.name}, {"unit", axis.unit}, {"low", axis.low}, {"high", axis.high}, {"bins", axis.bins}});
  for (const Elite& elite : map.elites)
    elites.push_back({{"cell", elite.cell}, {"individual", elite.individual}, {"value", elite.score}});
  return {{"objective", map.objective.name},
          {"axes", std::move(axes)},
          {"cells", map.cells()},
          {"elites", std::move(elites)}};
}

Json state_json(const NicheMap& map, const MapState& state) {
  const auto qd_score = map.qd_score(state);
  return {{"filled", state.filled},
          {"coverage", map.coverage(state)},
          {"qd_score", qd_score ? Json(*qd_score) : Json(nullptr)}};
}

Json note_titles_json(const std::vector<NoteHistory>& histories) {
  Json list = Json::array();
  for (const NoteHistory& history : histories)
    list.push_back({{"name", history.title.name}, {"unit", history.title.unit}, {"is_label", history.title.is_label}});
  return list;
}

Json notes_json(const std::vector<NoteHistory>& histories, std::size_t generation) {
  Json notes = Json::object();
  for (const NoteHistory& history : histories) {
    const std::vector<double>& values = history.living.at(generation);
    if (values.empty()) continue;
    if (history.title.is_label) {
      notes[history.title.name] = {{"groups", std::set(values.begin(), values.end()).size()}};
    } else {
      const auto [greatest, median] = best_and_median(values, true);
      notes[history.title.name] = {{"greatest", *greatest}, {"median", *median}};
    }
  }
  return notes;
}

Json labels_json(const std::vector<NoteHistory>& histories, std::size_t most) {
  Json list = Json::array();
  for (const NoteHistory& history : histories) {
    if (!history.title.is_label || !is_shared(history)) continue;
    const std::vector<double> labels = greatest_labels(history, most);
    const std::size_t generations = history.living.size();
    std::vector<std::vector<std::size_t>> counts(labels.size() + 1, std::vector<std::size_t>(generations));
    for (std::size_t generation = 0; generation < generations; ++generation)
      for (const double label : history.living[generation])
        ++counts[static_cast<std::size_t>(std::ranges::find(labels, label) - labels.begin())][generation];
    Json groups = Json::array();
    for (std::size_t i = 0; i < labels.size(); ++i) groups.push_back({{"label", labels[i]}, {"counts", counts[i]}});
    list.push_back({{"name", history.title.name}, {"groups", std::move(groups)}, {"others", counts.back()}});
  }
  return list;
}

}  // namespace evodevo
