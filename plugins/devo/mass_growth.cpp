// "Add new-masses during devo on a timer rather than or in addition to when we remove a mass. This allows the robot to
// potentially grow more masses than it started with" (paper, section VII). The timer is the operator's schedule.
#include "evodevo/helpers/arrivals.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// An application adds fewer masses than asked for if it finds no free position for the next one.
class MassGrowth final : public evodevo::Devo {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(masses_, "masses", {0, 100'000, "1"}, "Number of masses that are added at each application.");
    p.integer(limit_, "limit", {0, 10'000'000, "1"}, "Largest number of masses to which a body grows.");
    arrival_.declare(p);
  }

  evodevo::Traits traits() const override { return {.locality = 60}; }
  evodevo::RecordRequest observes() const override { return arrival_.request(); }
  evodevo::Measure measure(evodevo::EditKind) const override { return arrival_.measure.measure(); }

  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, evodevo::Rng& rng) const override {
    if (context.body.springs.empty()) return;
    const std::int64_t room = limit_ - static_cast<std::int64_t>(context.body.masses.size());
    evodevo::Chance chance(context, rng);
    evodevo::Arrivals arrivals(arrival_, context, chance);
    for (std::int64_t i = 0; i < std::min(masses_, room); ++i)
      if (!arrivals.find_position()) break;
    arrivals.come(edits);
  }

 private:
  std::int64_t masses_ = 5;
  std::int64_t limit_ = 2000;
  evodevo::ArrivalRule arrival_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<MassGrowth>("mass-growth",
                                                   "Adds masses and removes none, so that bodies grow "
                                                   "(paper, section VII)."))
