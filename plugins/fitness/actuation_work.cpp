// The cost of moving. Together with the fitness `distance`, it gives a Pareto front of two objectives (paper, section
// IV-F: "multiple criteria").
#include "evodevo/plugin.hpp"

namespace {

/// `settle` and `window` should be the same as those of the other fitness operator, so that both measure the same part
/// of a life.
class ActuationWork final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(settle_, "settle", {0, 3600, "s"}, "Time in which the body settles before the work is measured.");
    p.real(window_, "window", {0.001, 3600, "s"}, "Time in which the work is measured.");
  }

  evodevo::Request observes() const override { return {settle_, window_, true}; }

  std::vector<evodevo::Objective> objectives() const override { return {{"actuation-work", "J", false}}; }

  std::vector<double> score(const evodevo::Observation& observation) const override { return {observation.work}; }

 private:
  double settle_ = 10;
  double window_ = 10;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<ActuationWork>(
                   "actuation-work", "The positive work that muscles do on the body, to be minimised."))
