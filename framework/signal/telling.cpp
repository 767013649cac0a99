#include "signal/telling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

constexpr double enough = 0.8;  ///< repeatability

/// What was measured of one population.
class Told {
 public:
  Told(const std::vector<SignalNumber>& numbers, std::string population)
      : numbers_(numbers), population_(std::move(population)) {}

  const SignalNumber* find(std::string_view quantity, std::string_view of, std::string_view scale) const {
    const auto found = std::ranges::find_if(numbers_, [&](const SignalNumber& number) {
      return number.population == population_ && number.quantity == quantity && number.of == of &&
             number.scale == scale;
    });
    return found == numbers_.end() ? nullptr : &*found;
  }

 private:
  const std::vector<SignalNumber>& numbers_;
  std::string population_;
};

/// Returns a text such as "0.89 (0.82 to 0.93)".
std::string with_interval(const SignalNumber& number) {
  std::string text = fmt::format("{:.2f}", number.value);
  if (number.low && number.high) text += fmt::format(" ({:.2f} to {:.2f})", *number.low, *number.high);
  return text;
}

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

/// `at_first` is what was measured of random robots.
std::string on_repeatability(const Told& told, const Told& at_first, const Settings& settings,
                             const std::string& whose) {
  const SignalNumber* one = told.find("repeatability", "one life", "rank");
  if (one == nullptr)
    return "All " + whose + " have the same score in all lives, so that selection has nothing to choose from.";
  const SignalNumber* all = told.find("repeatability", "all lives", "rank");
  const SignalNumber& seen = all != nullptr ? *all : *one;
  std::string text = fmt::format(
      "Of what selection sees of {}, {} lies between robots, and the rest between lives of one "
      "(repeatability {}",
      whose, percent(std::clamp(seen.value, 0.0, 1.0)), with_interval(seen));
  if (all != nullptr) text += fmt::format("; of one life {}", with_interval(*one));
  text += "). ";
  constexpr double none = 0.05, all_but_rounding = 1 - 1e-9;
  if (one->value > all_but_rounding)
    return text +
           "Lives of one robot are the same: give them noise where they are measured ([[scenario]] start_noise), or "
           "this says nothing.";
  constexpr int most_worthwhile = 10;
  if (seen.value >= enough) return text + "More lives would change little.";
  constexpr double much = 0.3;
  const SignalNumber* before = at_first.find("repeatability", "one life", "rank");
  if (seen.value < much && before != nullptr && before->value >= much + seen.value)
    return text + fmt::format(
                      "Of random robots it is {} of one life: selection has used up what repeats, and goes on with "
                      "luck. More lives ([experiment] lives) or members that live again (remeasure) keep luck from "
                      "leading.",
                      with_interval(*before));
  if (one->value < none)
    return text + "No number of lives would help; another measure may, such as direction = \"any\" of distance.";
  const int lives = static_cast<int>(std::ceil(4 * (1 - one->value) / one->value - 1e-9));
  if (lives > settings.lives && lives <= most_worthwhile)
    return text + fmt::format("With [experiment] lives = {} it would be about {}.", lives, enough);
  if (lives > settings.lives) text += fmt::format("It would take {} lives to bring it to {}; ", lives, enough);
  return text + "another measure may tell robots apart sooner, such as direction = \"any\" of distance.";
}

std::string on_draws(const Told& told) {
  constexpr double loss = 0.2;
  const SignalNumber *same = told.find("repeatability", "one life", "rank"),
                     *redrawn = told.find("repeatability", "new draws", "rank");
  if (same == nullptr || redrawn == nullptr) return "";
  const std::string text =
      "With other draws of development in each life, the repeatability of one is " + with_interval(*redrawn);
  return redrawn->value > same->value - loss ? text + ", so that little of the score depends on these draws."
                                             : text +
                                                   ": much of the score depends on these draws. draws_between_lives = "
                                                   "\"new\" selects for robots that do "
                                                   "not depend on them.";
}

std::string on_heritability(const Told& told) {
  const SignalNumber *slope = told.find("heritability", "all children", "rank"),
                     *genetic = told.find("heritability / repeatability", "all children", "rank"),
                     *equal = told.find("equal bodies", "all children", "share");
  if (slope == nullptr || equal == nullptr) return "";
  std::string text = fmt::format("Of the difference in rank between parents, their children get {} (heritability {}",
                                 percent(std::clamp(slope->value, 0.0, 1.0)), with_interval(*slope));
  if (genetic != nullptr) text += fmt::format("; divided by the repeatability {}", with_interval(*genetic));
  text += "). ";
  constexpr double most_equal = 0.5, little = 0.4;
  if (equal->value > most_equal)
    return text + percent(equal->value) + " of them have their parent's body: larger mutations would try more.";
  if (genetic != nullptr && genetic->value < little) return text + "Smaller mutations would let them be more alike.";
  return text + (slope->value < little ? "Luck keeps them apart more than their genes do."
                                       : "Mutations are small enough for selection.");
}

std::string on_champion(const Told& told, const Objective& objective) {
  const SignalNumber *record = told.find("score", "record", "value"),
                     *again = told.find("score", "lives to come", "value"),
                     *redrawn = told.find("score", "new draws", "value"),
                     *children = told.find("score", "children", "value");
  if (record == nullptr) return "";
  const auto quantity = [&](const SignalNumber& number) { return short_quantity(number.value, objective.unit); };
  std::string text = "The best robot has the record " + quantity(*record);
  if (again == nullptr) return text + ", and fails in all lives to come.";
  text += "; in lives to come it reaches " + quantity(*again);
  if (redrawn != nullptr) text += ", with other draws of development " + quantity(*redrawn);
  if (children != nullptr) {
    text += ", and its children reach " + quantity(*children);
    if (record->value > 0) text += ", " + percent(children->value / record->value) + " of the record";
    text += " (medians)";
  }
  return text + ".";
}

}  // namespace

std::vector<std::string> sentences_on(const std::vector<SignalNumber>& numbers, const Settings& settings,
                                      const Objective& objective) {
  if (numbers.empty()) return {};
  const bool has_last =
      std::ranges::any_of(numbers, [](const SignalNumber& number) { return number.population == "last"; });
  const Told told(numbers, has_last ? "last" : "random");
  std::vector<std::string> sentences = {on_repeatability(told, Told(numbers, "random"), settings,
                                                         has_last ? "robots of the last population" : "random robots"),
                                        on_draws(told), on_heritability(told),
                                        on_champion(Told(numbers, "champion"), objective)};
  std::erase(sentences, "");
  return sentences;
}

Json signal_json(const std::vector<SignalNumber>& numbers, const Settings& settings, const Objective& objective) {
  const auto known = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  Json rows = Json::array();
  for (const SignalNumber& number : numbers)
    rows.push_back({{"population", number.population},
                    {"quantity", number.quantity},
                    {"of", number.of},
                    {"scale", number.scale},
                    {"value", number.value},
                    {"low", known(number.low)},
                    {"high", known(number.high)},
                    {"count", number.count}});
  return {{"objective", objective.name},
          {"unit", objective.unit},
          {"numbers", std::move(rows)},
          {"sentences", sentences_on(numbers, settings, objective)}};
}

}  // namespace evodevo
