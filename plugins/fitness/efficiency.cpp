// How far a body moves for its work.
#include <algorithm>
#include <stdexcept>

#include "evodevo/helpers/window.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// A body at rest does next to no work, so that a little motion would make it the most efficient of all. Work below
/// `least_work` therefore counts as `least_work`.
class Efficiency final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.vector(direction_, "direction", {-1000, 1000, "1"},
             "Direction in which the distance is measured: a vector of any length above 0.");
    window_.declare(p);
    p.real(least_work_, "least_work", {1e-6, 1e9, "J"}, "Work that counts if the muscles do less.");
  }

  evodevo::Request observes() const override {
    if (!(norm(direction_) > 0)) throw std::invalid_argument("direction must be longer than 0");
    evodevo::Request request = window_.request();
    request.work = true;
    return request;
  }

  std::vector<evodevo::Objective> objectives() const override { return {{"efficiency", "m/J", true}}; }

  std::vector<double> score(const evodevo::Observation& observation) const override {
    const evodevo::Vec3 way = observation.centre_after - observation.centre_before;
    return {dot(way, direction_) / norm(direction_) / std::max<double>(observation.work, least_work_)};
  }

 private:
  evodevo::Vec3 direction_ = {1, 0, 0};
  evodevo::MeasuringWindow window_;
  double least_work_ = 10;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Efficiency>(
                   "efficiency", "The distance in a direction for each joule of work that the muscles do."))
