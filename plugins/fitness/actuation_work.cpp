// The cost of moving. Together with the fitness `distance`, it gives a Pareto front of two objectives (paper, section
// IV-F: "multiple criteria").
#include "evodevo/helpers/window.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// `settle` and `window` should be the same as those of the other fitness operator, so that both measure the same part
/// of a life.
class ActuationWork final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override { window_.declare(p); }

  evodevo::Request observes() const override {
    evodevo::Request request = window_.request();
    request.work = true;
    return request;
  }

  std::vector<evodevo::Objective> objectives() const override { return {{"actuation-work", "J", false}}; }

  std::vector<double> score(const evodevo::Observation& observation) const override { return {observation.work}; }

 private:
  evodevo::MeasuringWindow window_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<ActuationWork>(
                   "actuation-work", "The positive work that muscles do on the body, to be minimised."))
