// Robots must not be too heavy.
#include "evodevo/plugin.hpp"

namespace {

class Weight final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(most_, "most", {0, 1e6, "kg"}, "Largest weight of a robot that is feasible.");
  }

  evodevo::Request observes() const override { return {.settle = 0, .window = 0.5}; }

  std::vector<evodevo::Objective> objectives() const override {
    return {{"overweight", "kg", true, evodevo::Role::constraint}};
  }

  std::vector<double> score(const evodevo::Observation& seen) const override {
    double weight = 0;
    for (const evodevo::Mass& mass : seen.body->masses) weight += mass.mass;
    return {weight - most_};
  }

 private:
  double most_ = 5;
};

}  // namespace

EVODEVO_PLUGIN("1.0.0", "MIT", evodevo::operator_entry<Weight>("outside.weight", "How much too heavy a robot is."))
