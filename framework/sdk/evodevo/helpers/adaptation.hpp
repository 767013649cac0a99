// For devo operators that change a property of springs, such as that of the most stressed ones: "Modify the tension of
// highest stress springs rather than adding new springs" (paper, section VII).
#pragma once

#include "evodevo/devo.hpp"
#include "evodevo/helpers/stress.hpp"

namespace evodevo {

/// Returns the new value of a property, held between `low` and `high`. A value that is already beyond a bound moves no
/// further away from it.
inline double within_bounds(double before, double after, double low, double high) {
  return after < before ? std::max(after, std::min(before, low)) : std::min(after, std::max(before, high));
}

/// Returns the change that gives a spring a new stiffness, N/m, for a cause, or nothing if it has this stiffness. Its
/// material stays, so that bodies do not get a material for every spring.
inline std::optional<ChangedSpring> with_stiffness(const Body& body, std::uint32_t index, double stiffness,
                                                   double cause = no_cause) {
  const Spring& spring = body.springs[index];
  const double factor = stiffness / body.materials[spring.material].stiffness;
  if (factor == spring.stiffness_factor || stiffness == body.stiffness(spring)) return std::nullopt;
  return ChangedSpring{.spring = index, .stiffness_factor = factor, .cause = cause};
}

/// Multiplies a property of the most stressed springs by a factor, within bounds. Springs without the property are
/// skipped. A value that is already beyond its bound stays as it is.
class Adaptation : public Devo {
 public:
  RecordRequest observes() const final { return measure_.request(); }
  Measure measure(EditKind) const final { return measure_.measure(); }

  void develop(const DevoContext& context, Edits& edits, Rng& rng) const final {
    const std::vector<double> stress_of = measure_.of(context);
    std::vector<std::uint32_t> springs;
    std::vector<double> stress;
    for (std::uint32_t s = 0; s < context.body.springs.size(); ++s) {
      if (!(value(context.body, s) > 0)) continue;
      springs.push_back(s);
      stress.push_back(stress_of[s]);
    }
    Chance chance(context, rng);
    for (const std::uint32_t i : most_stressed(stress, static_cast<std::size_t>(springs_), chance)) {
      const double before = value(context.body, springs[i]),
                   after = within_bounds(before, factor_ * before, low_, high_);
      std::optional<ChangedSpring> change = changed(context.body, springs[i], after);
      if (after == before || !change) continue;
      change->cause = stress[i];
      edits.change_spring(springs[i], *change);
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
  /// Returns the change that gives the property of a spring a new value, or nothing if it has this value.
  virtual std::optional<ChangedSpring> changed(const Body& body, std::uint32_t spring, double value) const = 0;

  std::int64_t springs_ = 125;
  double factor_, low_, high_;
  StressMeasure measure_;
};

}  // namespace evodevo
