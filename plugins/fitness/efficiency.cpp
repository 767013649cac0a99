// How far a body moves for its work.
#include <algorithm>

#include "evodevo/helpers/window.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// A body at rest does next to no work, so that a little motion would make it the most efficient of all. Work below
/// `least_work` therefore counts as `least_work`.
class Efficiency final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override {
    direction_.declare(p);
    window_.declare(p);
    p.real(least_work_, "least_work", {1e-6, 1e9, "J"}, "Work that counts if the muscles do less.");
  }

  evodevo::Request observes() const override {
    evodevo::Request request = direction_.with_direction(window_.request());
    request.work = true;
    return request;
  }

  std::vector<evodevo::Objective> objectives() const override { return {{"efficiency", "m/J", true}}; }

  std::vector<double> score(const evodevo::Observation& observation) const override {
    return {direction_.distance(observation) / std::max<double>(observation.work, least_work_)};
  }

 private:
  evodevo::MeasuredDirection direction_;
  evodevo::MeasuringWindow window_;
  double least_work_ = 10;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Efficiency>(
                   "efficiency", "The distance in a direction for each joule of work that the muscles do."))
