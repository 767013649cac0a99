// Novelty search (Lehman and Stanley 2011a), with local competition (Lehman and Stanley 2011b).
#include "evodevo/helpers/selection/novelty.hpp"

#include <set>

#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/memory.hpp"
#include "evodevo/helpers/selection/pareto.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Behaviour;
using evodevo::SelectionContext;

/// The individuals survive whose descriptors are farthest from those of their nearest neighbours, in the population and
/// in an archive; who is in both counts once. With local competition, the number of these neighbours that have a lower
/// first score is a second objective, and whole Pareto layers survive. Some newborns of each generation, drawn at
/// random, join the archive for good (Lehman and Stanley 2010). The memory holds the archive.
class NoveltySearch final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(neighbours_, "neighbours", {1, 1000, "1"},
              "Number of nearest neighbours, the mean distance to which is the novelty.");
    p.integer(archived_, "archived", {0, 1000, "1"},
              "Number of newborns of each generation, drawn at random, that join the archive.");
    p.flag(competition_, "local_competition",
           "Whether the number of neighbours that have a lower first score is an objective, too.");
  }

  evodevo::Traits traits() const override { return {.is_elitist = false, .least_descriptors = 1}; }
  std::vector<evodevo::NoteTitle> notes() const override { return {{"novelty"}}; }
  std::vector<std::string> memory() const override { return {"ids", "scores", "places"}; }

  std::vector<evodevo::Couple> parents(const SelectionContext& context, std::uint32_t count,
                                       evodevo::Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, evodevo::draw_any);
  }

  evodevo::Survival survivors(const SelectionContext& context, std::uint32_t population,
                              evodevo::Rng& rng) const override {
    const auto order = best_first(context.rows);
    std::vector<Behaviour> behaviours;  // of those who did not fail, which come first
    for (const std::uint32_t row : order)
      if (context.rows[row].ok()) behaviours.push_back(behaviour_of(context.rows[row], context));
    Archive archive(context);
    archive.forget_failed(context.rows);
    const auto found =
        evodevo::novelty(behaviours, archive.of_others(context.rows), static_cast<std::size_t>(neighbours_));

    evodevo::Survival survival;
    std::vector<evodevo::Point> points(order.size());  // by row
    for (std::uint32_t i = 0; i < found.size(); ++i) {
      points[order[i]] = {found[i].distance};
      if (competition_) points[order[i]].push_back(found[i].beaten);
      survival.notes.push_back({order[i], 0, found[i].distance});
    }
    survival.rows = evodevo::best_layers(points, order, population);

    auto newborns = order;
    std::erase_if(newborns, [&](auto row) { return !context.rows[row].ok() || !context.rows[row].is_newborn; });
    rng.shuffle(newborns);
    for (const std::uint32_t row : evodevo::first_rows(std::move(newborns), static_cast<std::size_t>(archived_)))
      archive.add(context.rows[row].id, behaviour_of(context.rows[row], context));
    survival.memory = archive.memory();
    return survival;
  }

 private:
  /// The memory: individuals with their behaviours.
  class Archive {
   public:
    explicit Archive(const SelectionContext& context) {
      if (context.memory.empty()) return;
      ids_ = whole_numbers(context.memory, "ids");
      scores_ = context.memory.list("scores");
      places_ = places_in(context.memory, "places", ids_.size(), context.descriptors.size());
      if (scores_.size() != ids_.size())
        evodevo::SelectionMemory::fail("has " + std::to_string(scores_.size()) + " scores, expected " +
                                       std::to_string(ids_.size()));
    }

    /// Forgets those in the table who have lost their fitness since they were archived.
    void forget_failed(std::span<const evodevo::Candidate> rows) {
      std::set<std::uint32_t> failed;
      for (const evodevo::Candidate& row : rows)
        if (!row.ok()) failed.insert(row.id);
      std::size_t kept = 0;
      for (std::size_t i = 0; i < ids_.size(); ++i) {
        if (failed.contains(ids_[i])) continue;
        ids_[kept] = ids_[i], scores_[kept] = scores_[i], places_[kept] = places_[i];
        ++kept;
      }
      ids_.resize(kept), scores_.resize(kept), places_.resize(kept);
    }

    /// Returns the behaviours of those who are not in the table.
    std::vector<Behaviour> of_others(std::span<const evodevo::Candidate> rows) const {
      std::set<std::uint32_t> present;
      for (const evodevo::Candidate& row : rows) present.insert(row.id);
      std::vector<Behaviour> others;
      for (std::size_t i = 0; i < ids_.size(); ++i)
        if (!present.contains(ids_[i])) others.push_back({places_[i], scores_[i]});
      return others;
    }
    void add(std::uint32_t id, const Behaviour& behaviour) {
      ids_.push_back(id);
      scores_.push_back(behaviour.score);
      places_.push_back(behaviour.place);
    }
    evodevo::SelectionMemory memory() const {
      return {.lists = {{"ids", evodevo::memory_list(ids_)},
                        {"scores", scores_},
                        {"places", evodevo::list_of_places(places_)}}};
    }

   private:
    std::vector<std::uint32_t> ids_;
    std::vector<double> scores_;
    std::vector<evodevo::Coordinates> places_;
  };

  static Behaviour behaviour_of(const evodevo::Candidate& row, const SelectionContext& context) {
    return {place_of(row, context.descriptors), row.scores[0]};
  }

  std::int64_t neighbours_ = 15;
  std::int64_t archived_ = 6;
  bool competition_ = false;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<NoveltySearch>("novelty",
                                                      "Those survive whose descriptors are unlike those of all others, "
                                                      "past and present (Lehman & Stanley 2011)."))
