// Novelty search (Lehman and Stanley 2011a), with local competition (Lehman and Stanley 2011b).
#include "evodevo/helpers/selection/novelty.hpp"

#include "evodevo/helpers/pareto.hpp"
#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/memory.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Behaviour;

/// The individuals survive whose descriptors are farthest from those of their nearest neighbours, in the population and
/// in an archive. With local competition, the number of these neighbours that have a lower first score is a second
/// objective, and whole Pareto layers survive. Some newborns of each generation, drawn at random, join the archive for
/// good (Lehman and Stanley 2010). The memory holds the archive.
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

  std::vector<std::pair<std::uint32_t, std::uint32_t>> parents(std::span<const evodevo::Candidate> rows,
                                                               std::uint32_t count, evodevo::Rng& rng) const override {
    return draw_pairs(rows, count, rng, evodevo::draw_any);
  }

  evodevo::Survival survive(const evodevo::SelectionContext& context, std::uint32_t population,
                            evodevo::Rng& rng) const override {
    const auto order = best_first(context.rows);
    std::vector<Behaviour> behaviours;  // of those who did not fail, which come first
    for (const std::uint32_t row : order)
      if (const evodevo::Candidate& candidate = context.rows[row]; candidate.ok())
        behaviours.push_back({place_of(candidate, context.descriptors), candidate.scores[0]});
    std::vector<Behaviour> archive = archive_in(context);
    const auto found = evodevo::novelty(behaviours, archive, static_cast<std::size_t>(neighbours_));

    evodevo::Survival survival;
    std::vector<evodevo::Point> points(order.size());
    for (std::uint32_t i = 0; i < found.size(); ++i) {
      points[i] = {found[i].distance};
      if (competition_) points[i].push_back(found[i].beaten);
      survival.notes.push_back({order[i], 0, found[i].distance});
    }
    for (const std::uint32_t i : evodevo::best_layers(points, population)) survival.rows.push_back(order[i]);

    std::vector<std::uint32_t> newborns;
    for (std::uint32_t i = 0; i < behaviours.size(); ++i)
      if (context.rows[order[i]].is_newborn) newborns.push_back(i);
    rng.shuffle(newborns);
    newborns.resize(std::min(newborns.size(), static_cast<std::size_t>(archived_)));
    for (const std::uint32_t i : newborns) archive.push_back(behaviours[i]);
    survival.memory = written(archive);
    return survival;
  }

 private:
  static std::vector<Behaviour> archive_in(const evodevo::SelectionContext& context) {
    evodevo::MemoryReader reader(context.memory);
    std::vector<Behaviour> archive;
    while (reader.left() > 0) {
      auto place = reader.read_list<double>();
      archive.push_back({std::move(place), reader.read<double>()});
    }
    return archive;
  }

  static std::vector<std::byte> written(const std::vector<Behaviour>& archive) {
    evodevo::MemoryWriter writer;
    for (const Behaviour& one : archive) {
      writer.write(one.place);
      writer.write(one.score);
    }
    return writer.bytes();
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
