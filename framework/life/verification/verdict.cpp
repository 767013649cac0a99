#include "life/verification/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/text.hpp"
#include "life/measurement/combining.hpp"

namespace evodevo {
namespace {

constexpr double enough = 0.5;  ///< fraction of the fitness that an individual must keep, 1

const Trial* find(const Verification& verification, const std::string& name) {
  const auto found = std::ranges::find(verification.trials, name, &Trial::name);
  return found == verification.trials.end() ? nullptr : &*found;
}

/// Returns the marks of an individual, each with the first trial that shows it, in the order of verify_marks().
std::vector<Mark> all_marks(const Verification& verification, bool maximise) {
  std::vector<Mark> marks;
  const auto mark_by = [&](const char* name, Status status, const auto& shows) {
    const Trial* trial = find(verification, name);
    const bool is_marked = !marks.empty() && marks.back().status == status;
    if (trial != nullptr && !is_marked && shows(*trial)) marks.push_back({status, *trial});
  };
  const auto is_lost = [&](const Trial& trial) { return !held(verification, trial, maximise); };
  const double half = enough * verification.fitness;
  if (maximise && verification.fitness > 0) {
    mark_by("no-muscles", Status::passive, [&](const Trial& trial) { return trial.value && *trial.value > half; });
    mark_by("settled", Status::passive, [&](const Trial& trial) { return trial.value && *trial.value < half; });
  }
  mark_by(new_lives_trial, Status::lucky, is_lost);
  mark_by("quarter-step", Status::artefact, is_lost);
  mark_by("other-method", Status::artefact, is_lost);
  return marks;
}

/// The lives to come of one kind: all trials whose names begin like this, in their order.
std::vector<const Trial*> lives_to_come(const Verification& verification, const char* kind) {
  std::vector<const Trial*> lives;
  for (const Trial& trial : verification.trials)
    if (trial.name.starts_with(kind)) lives.push_back(&trial);
  return lives;
}

/// Returns a text such as "3 of 4".
std::string kept_text(const Verification& verification, std::span<const Trial* const> lives, bool maximise) {
  const auto kept =
      std::ranges::count_if(lives, [&](const Trial* trial) { return held(verification, *trial, maximise); });
  return fmt::format("{} of {}", kept, lives.size());
}

/// The median of the first objective in some lives; one without a fitness counts as worse than all others.
double median(std::span<const Trial* const> lives, bool maximise) {
  std::vector<double> values;
  const double worst = std::numeric_limits<double>::infinity() * (maximise ? -1 : 1);
  for (const Trial* trial : lives) values.push_back(trial->value.value_or(worst));
  return combined(std::move(values), Over::median, maximise);
}

std::string median_text(std::span<const Trial* const> lives, const Objective& objective) {
  const double value = median(lives, objective.maximise);
  return std::isfinite(value) ? short_quantity(value, objective.unit) : "no fitness";
}

}  // namespace

bool held(const Verification& verification, const Trial& trial, bool maximise) {
  if (!trial.value) return false;
  const double lost = maximise ? verification.fitness - *trial.value : *trial.value - verification.fitness;
  return lost <= (1 - enough) * std::abs(verification.fitness);
}

std::vector<std::string> marks(const Verification& verification, bool maximise) {
  std::vector<std::string> names;
  for (const Mark& mark : all_marks(verification, maximise)) names.emplace_back(name(mark.status));
  std::ranges::sort(names);
  return names;
}

std::optional<Mark> first_mark(const Verification& verification, bool maximise) {
  std::vector<Mark> marks = all_marks(verification, maximise);
  return marks.empty() ? std::nullopt : std::optional(std::move(marks.front()));
}

std::string marks_text(const Verification& verification, bool maximise) {
  std::string text;
  for (const std::string& mark : marks(verification, maximise)) text += (text.empty() ? "" : ", ") + mark;
  return text.empty() ? "verified" : text;
}

std::string verdict_text(const Verification& verification, bool maximise) {
  const auto same = lives_to_come(verification, reborn_trial), redrawn = lives_to_come(verification, redrawn_trial);
  std::string text = marks_text(verification, maximise);
  if (same.empty()) return text;
  text += ", kept in " + kept_text(verification, same, maximise) + " lives to come";
  if (!redrawn.empty())
    text += " with the same draws and in " + kept_text(verification, redrawn, maximise) + " with new ones";
  return text;
}

std::string choice_text(std::span<const Verification> verifications, const Objective& objective) {
  const Verification* best = nullptr;
  double most = 0;
  std::size_t candidates = 0;
  for (const Verification& one : verifications) {
    const std::vector<const Trial*> lives = lives_to_come(one, reborn_trial);
    if (lives.size() <= choosing_births) continue;
    ++candidates;
    const double value = median(std::span(lives).first(choosing_births), objective.maximise);
    if (best != nullptr && !(objective.maximise ? value > most : value < most)) continue;
    best = &one;
    most = value;
  }
  if (candidates < 2) return "";
  const auto same = lives_to_come(*best, reborn_trial), redrawn = lives_to_come(*best, redrawn_trial);
  std::string text = fmt::format(
      "individual {} is the best of these {} in the first {} lives to come; the others tell: {} {}", best->individual,
      candidates, choosing_births, objective.name, median_text(std::span(same).subspan(choosing_births), objective));
  if (!redrawn.empty()) text += " with the same draws, " + median_text(redrawn, objective) + " with new ones";
  return text;
}

}  // namespace evodevo
