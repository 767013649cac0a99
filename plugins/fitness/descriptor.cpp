// Numbers that say what a body does and is like, without saying that it is good.
#include <algorithm>
#include <string>

#include "evodevo/helpers/window.hpp"
#include "evodevo/plugin.hpp"

namespace {

class Descriptor final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.choice(what_, "what", {"height", "contact", "spread", "masses"},
             "What is described: the mean height of the body, the mean share of its masses that touch the ground, the "
             "mean of the longer horizontal side of its bounding box, or its number of masses.");
    p.reals(range_, "range", {-1e9, 1e9},
            "Smallest and largest value that is expected, in the unit of the descriptor.");
    p.integer(bins_, "bins", {1, evodevo::Objective::most_bins, "1"},
              "Number of cells into which maps of niches divide the range.");
    window_.declare_sampled(p);
    p.require(range_.empty() || (range_.size() == 2 && range_[0] < range_[1]), "range",
              "expected two numbers, the smaller first");
  }

  evodevo::Request observes() const override {
    return window_.request({.box = what_ != "contact" && what_ != "masses", .contact = what_ == "contact"});
  }

  std::vector<evodevo::Objective> objectives() const override {
    evodevo::Objective descriptor{what_, what_ == "contact" || what_ == "masses" ? "1" : "m"};
    descriptor.role = evodevo::Role::descriptor;
    descriptor.low = range_.empty() ? 0 : range_[0];
    descriptor.high = range_.empty() ? (what_ == "masses" ? 1000 : what_ == "contact" ? 1 : 2) : range_[1];
    descriptor.bins = static_cast<std::uint32_t>(bins_);
    return {descriptor};
  }

  std::vector<double> score(const evodevo::Observation& observation) const override {
    const evodevo::Samples& samples = observation.samples;
    if (what_ == "masses") return {static_cast<double>(observation.body->masses.size())};
    double sum = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) sum += value(samples, i);
    return {sum / static_cast<double>(samples.size() - 1)};
  }

 private:
  double value(const evodevo::Samples& samples, std::size_t i) const {
    if (what_ == "contact") return samples.contact(i);
    const evodevo::Vec3 side = samples.box(i).high - samples.box(i).low;
    return what_ == "height" ? side.z : std::max(side.x, side.y);
  }

  std::string what_ = "height";
  std::vector<double> range_;
  std::int64_t bins_ = 10;
  evodevo::MeasuringWindow window_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Descriptor>(
                   "descriptor",
                   "Where a robot lies in the space of behaviours, for maps of niches and for selection operators "
                   "such as map-elites."))
