#include <algorithm>

#include "experiment/tables/tables.hpp"

namespace evodevo {

void check_lives(TomlReader& top, const Settings& settings, bool develops) {
  const bool differ = settings.birth_noise > 0 || std::ranges::any_of(settings.scenarios, &Scenario::is_random) ||
                      (develops && settings.development.draws_between_lives == DrawsBetweenLives::anew);
  if (differ) return;
  const auto refuse = [&](const char* table, const std::string& key) {
    visit_table(top, table, true, [&](TomlReader& t) {
      t.report(key,
               std::string("all lives would be the same; set experiment.birth_noise, ") +
                   (develops ? "development.draws_between_lives = \"new\", " : "") +
                   "or start_noise or damage of a scenario, or remove " + key,
               {"experiment", "development", "scenario", "selection"});
    });
  };
  if (settings.lives > 1) refuse("experiment", "lives");
  if (settings.remeasure > 0) refuse("selection", "remeasure");
}

}  // namespace evodevo
