// Hebbian learning by the springs of a body: what pulls and works together becomes stiffer.
#include <algorithm>
#include <cmath>

#include "evodevo/helpers/adaptation.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Body;
using evodevo::DevoContext;
using evodevo::Edits;
using evodevo::Spring;

/// Hebb's postulate for springs: the stiffness k_s of a spring grows with the product of its own activity and that of
/// the springs at the same masses (Hebb 1949, "The Organization of Behavior"). With the mean force T_s (N; positive if
/// the spring pulls) and the work W_s (J) of its muscle in the last cycle,
///
///   x_s  =  max(T_s, 0) / mean of max(T, 0)  *  max(W_s, 0) / mean of max(W, 0)    activity, means over all springs
///   X_s  <-  (1 - latest) X_s + latest x_s                                         running mean, 0 for new springs
///   Y_s  =  mean of X over the other springs at the two masses of s
///   H_s  =  X_s Y_s / largest X Y of all springs                                   0 to 1
///   k_s  <-  k_s (1 + rate H_s) * sum of k / sum of k (1 + rate H)
///
/// The last factor keeps the sum of all stiffnesses constant, apart from springs at a bound: what is less active than
/// others becomes softer. Oja (1982, "Simplified neuron model as a principal component analyzer") bounds weights in the
/// same way, by the norm of the weights after the step. If no active spring meets another, nothing changes.
class Hebbian final : public evodevo::Devo {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(rate_, "rate", {0, 1, "1"},
           "Relative growth of the stiffness of the spring with the largest product of activities, before all springs "
           "are scaled back to the same total stiffness.");
    p.real(latest_, "latest", {0.01, 1, "1"}, "Weight of the last cycle in the running mean of a spring's activity.");
    p.real(low_, "low", {1e-3, 1e9, "N/m"}, "Stiffness below which no spring is softened.");
    p.real(high_, "high", {1e-3, 1e9, "N/m"}, "Stiffness above which no spring is stiffened.");
    p.require(low_ <= high_, "low", "expected at most `high`");
  }

  evodevo::RecordRequest observes() const override { return {.muscle_work = true, .tension = true}; }
  evodevo::Measure measure(evodevo::EditKind) const override { return {"joint activity", "1"}; }
  std::vector<std::string> spring_memory() const override { return {"activity"}; }

  void develop(const DevoContext& context, Edits& edits, evodevo::Rng&) const override {
    const std::vector<double> activity = running_mean(context), joint = joint_activity(context.body, activity);
    for (std::uint32_t s = 0; s < activity.size(); ++s) edits.remember_spring(s, {activity[s]});
    if (joint.empty()) return;
    const Body& body = context.body;
    const auto stiffness = [&](std::uint32_t s) { return body.stiffness(body.springs[s]); };
    double before_all = 0, after_all = 0;
    for (std::uint32_t s = 0; s < joint.size(); ++s) {
      before_all += stiffness(s);
      after_all += stiffness(s) * (1 + rate_ * joint[s]);
    }
    for (std::uint32_t s = 0; s < joint.size(); ++s) {
      const double before = stiffness(s), grown = before * (1 + rate_ * joint[s]) * (before_all / after_all),
                   after = evodevo::within_bounds(before, grown, low_, high_);
      if (const auto change = evodevo::with_stiffness(body, s, after, joint[s])) edits.change_spring(s, *change);
    }
  }

 private:
  /// Returns the positive values of a record relative to their mean over all springs; all 0 if none is positive. Values
  /// that are not finite count as 0.
  static std::vector<double> relative(std::span<const double> record) {
    std::vector<double> values;
    double sum = 0;
    for (const double value : record) sum += values.emplace_back(value > 0 && std::isfinite(value) ? value : 0);
    if (sum > 0)
      for (double& value : values) value *= static_cast<double>(values.size()) / sum;
    return values;
  }

  /// Returns X of every spring.
  std::vector<double> running_mean(const DevoContext& context) const {
    const std::vector<double> pull = relative(context.tension), work = relative(context.muscle_work);
    std::vector<double> mean;
    for (std::size_t s = 0; s < pull.size(); ++s)
      mean.push_back((1 - latest_) * context.spring_memory[s][0] + latest_ * pull[s] * work[s]);
    return mean;
  }

  /// Returns H of every spring, or nothing if X Y is 0 for all springs.
  static std::vector<double> joint_activity(const Body& body, const std::vector<double>& activity) {
    std::vector<double> sum(body.masses.size()), count(body.masses.size());
    for (std::size_t s = 0; s < activity.size(); ++s)
      for (const std::uint32_t end : {body.springs[s].a, body.springs[s].b}) {
        sum[end] += activity[s];
        ++count[end];
      }
    std::vector<double> joint;
    for (std::size_t s = 0; s < activity.size(); ++s) {
      const Spring& spring = body.springs[s];
      const double others = count[spring.a] + count[spring.b] - 2;
      // below 0 only by rounding
      const double of_others = std::max(sum[spring.a] - activity[s] + (sum[spring.b] - activity[s]), 0.0);
      joint.push_back(others > 0 ? activity[s] * of_others / others : 0);
    }
    const double largest = joint.empty() ? 0 : *std::max_element(joint.begin(), joint.end());
    if (!(largest > 0)) return {};
    for (double& value : joint) value /= largest;
    return joint;
  }

  double rate_ = 0.05;
  double latest_ = 0.5;
  double low_ = 1000;
  double high_ = 20'000;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Hebbian>("hebbian",
                                                "Makes springs stiffer that pull and work together, and the others "
                                                "softer (Hebb 1949)."))
