#include "report/signal.hpp"

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

/// The bounds of the interval; the number itself, if it has none.
double low(const SignalNumber& number) { return number.low.value_or(number.value); }
double high(const SignalNumber& number) { return number.high.value_or(number.value); }

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
  constexpr int most_worthwhile = 10;
  if (one->value > all_but_rounding)
    return text +
           "Lives of one robot are the same: give them noise where they are measured ([[scenario]] start_noise), or "
           "this says nothing.";
  if (seen.value >= enough) return text + "More lives would change little.";
  const SignalNumber* before = at_first.find("repeatability", "one life", "rank");
  if (before != nullptr && low(*before) > high(*one))
    return text + fmt::format(
                      "Of one life of random robots it is {}: selection has used up much of what repeats. More lives "
                      "([experiment] lives), or members that live again (remeasure), keep luck from leading.",
                      with_interval(*before));
  if (one->value < none) return text + "No number of lives would help; another measure may.";
  const int lives = static_cast<int>(std::ceil(4 * (1 - one->value) / one->value - 1e-9));
  if (lives <= settings.lives) return text + "Another measure may tell robots apart sooner.";
  text += fmt::format("The mean of {} lives would have about {}", lives, enough);
  return text + (lives <= most_worthwhile ? fmt::format(" ([experiment] lives = {}).", lives)
                                          : "; another measure may tell robots apart sooner.");
}

std::string on_draws(const Told& told, const Settings& settings) {
  constexpr double loss = 0.2;
  const SignalNumber *same = told.find("repeatability", "one life", "rank"),
                     *redrawn = told.find("repeatability", "new draws", "rank");
  if (same == nullptr || redrawn == nullptr) return "";
  const std::string text =
      "With other draws of development in each life, the repeatability of one is " + with_interval(*redrawn);
  if (redrawn->value > same->value - loss) return text + ", so that these draws decide little.";
  return text + ": which robots are ahead depends much on these draws. " +
         (settings.lives > 1 ? "Lives" : "Several lives") +
         " with draws_between_lives = \"new\" select for robots that do not depend on them.";
}

/// `is_whole`: whether no more robots could be measured.
std::string on_heritability(const Told& told, bool is_whole) {
  const SignalNumber *slope = told.find("heritability", "all children", "rank"),
                     *genetic = told.find("heritability / repeatability", "all children", "rank"),
                     *equal = told.find("equal bodies", "all children", "share");
  if (slope == nullptr || equal == nullptr) return "";
  std::string text = fmt::format("Of a difference in rank between parents, their children get {} (heritability {}",
                                 percent(std::clamp(slope->value, 0.0, 1.0)), with_interval(*slope));
  if (genetic != nullptr) text += fmt::format("; divided by the repeatability {}", with_interval(*genetic));
  text += "). ";
  constexpr double most_equal = 0.5, half = 0.5, some = 0.2;
  if (equal->value > most_equal)
    return text + percent(equal->value) + " of them have their parent's body: larger mutations would try more.";
  if (genetic != nullptr && high(*genetic) < half) return text + "Smaller mutations would let them be more alike.";
  if (low(*slope) > some) return text + "Mutations are small enough for selection.";
  if (high(*slope) < half) return text + "Luck or mutations outweigh what parents pass on.";
  return text + (is_whole ? "Other runs would tell this more exactly, or a larger population."
                          : "More robots (--robots) would tell this more exactly.");
}

std::string on_champion(const Told& told, const Objective& objective) {
  const SignalNumber* record = told.find("score", "record", "value");
  if (record == nullptr) return "";
  const auto quantity = [&](const SignalNumber& number) { return short_quantity(number.value, objective.unit); };
  std::string text = "The best robot has the record " + quantity(*record);
  for (const auto& [of, whose] : {std::pair{"lives to come", "lives to come"},
                                  {"new draws", "lives with other draws of development"},
                                  {"children", "its children"}}) {
    if (told.find("failures", of, "share") == nullptr) continue;
    const SignalNumber* score = told.find("score", of, "value");
    text += std::string("; ") + (score != nullptr ? "the median of " : "at least half of ") + whose +
            (score != nullptr ? " is " + quantity(*score) : " fail");
    const bool has_share = score != nullptr && objective.maximise && record->value > 0 && score->value > 0;
    if (has_share) text += ", " + percent(score->value / record->value) + " of it";
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
  const SignalNumber* parents = told.find("score", "parents", "value");
  const bool is_whole = has_last && parents != nullptr && parents->count >= settings.population;
  std::vector<std::string> sentences = {on_champion(Told(numbers, "champion"), objective),
                                        on_repeatability(told, Told(numbers, "random"), settings,
                                                         has_last ? "robots of the last population" : "random robots"),
                                        on_draws(told, settings), on_heritability(told, is_whole)};
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
