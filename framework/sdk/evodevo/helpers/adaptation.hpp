// For devo operators that change a property of the most stressed springs: "Modify the tension of highest stress
// springs rather than adding new springs" (paper, section VII).
#pragma once

#include "evodevo/devo.hpp"
#include "evodevo/helpers/stress.hpp"

namespace evodevo {

/// Multiplies a property of the most stressed springs by a factor, within bounds. Springs without the property are
/// skipped. A value that is already beyond its bound stays as it is.
class Adaptation : public Devo {
 public:
  SpringRequest observes() const final { return measure_.request(); }
  Measure measure(Causes::List) const final { return measure_.measure(); }

  void develop(const DevoContext& context, Edits& edits, Rng& rng) const final {
    const std::vector<double> stress_of = measure_.of(context);
    std::vector<std::uint32_t> springs;
    std::vector<double> stress;
    for (std::uint32_t s = 0; s < context.body.springs.size(); ++s) {
      if (!(value(context.body, s) > 0)) continue;
      springs.push_back(s);
      stress.push_back(stress_of[s]);
    }
    for (const std::uint32_t i : most_stressed(stress, static_cast<std::size_t>(springs_), rng)) {
      const double before = value(context.body, springs[i]), after = adapted(before);
      if (after == before) continue;
      change(context.body, springs[i], after, edits);
      edits.causes.changed_springs.push_back(stress[i]);
    }
  }

 protected:
  Adaptation(double factor, double low, double high) : factor_(factor), low_(low), high_(high) {}

  void declare(Parameters& p, Range range, std::string_view low_text, std::string_view high_text) {
    p.integer(springs_, "springs", {1, 1'000'000, "1"},
              "Number of most stressed springs that are changed at each application.");
    p.real(factor_, "factor", {0.5, 2, "1"},
           "Factor by which the property of a spring is multiplied, below or above 1.");
    p.real(low_, "low", range, low_text);
    p.real(high_, "high", range, high_text);
    p.require(factor_ != 1, "factor", "changes nothing; expected a factor below or above 1");
    p.require(low_ <= high_, "low", "expected at most `high`");
    measure_.declare(p);
  }

 private:
  /// Returns the property of a spring, or 0 if the spring does not have it.
  virtual double value(const Body& body, std::uint32_t spring) const = 0;
  /// Adds to `edits` the change that gives the property of a spring a new value.
  virtual void change(const Body& body, std::uint32_t spring, double value, Edits& edits) const = 0;

  double adapted(double before) const {
    const double after = factor_ * before;
    return factor_ < 1 ? std::max(after, std::min(before, low_)) : std::min(after, std::max(before, high_));
  }

  std::int64_t springs_ = 125;
  double factor_, low_, high_;
  StressMeasure measure_;
};

}  // namespace evodevo
