// Tournament selection of parents (Goldberg and Deb 1991).
#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// Individuals are compared by their first score; ties are broken by the other scores, then by youth.
class TournamentParents final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(size_, "size", {1, 1000, "1"}, "Number of individuals drawn for each parent, of which the best breeds.");
  }

  std::vector<evodevo::Couple> parents(const evodevo::SelectionContext& context, std::uint32_t count,
                                       evodevo::Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, evodevo::Tournament{size_});
  }

 private:
  std::int64_t size_ = 2;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<TournamentParents>("tournament",
                                                          "Parents are the winners of tournaments (Goldberg & Deb "
                                                          "1991)."))
