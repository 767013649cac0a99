#include "archive/progress.hpp"

#include <algorithm>
#include <map>

#include "base/text.hpp"

namespace evodevo {

bool is_finished(const Settings& settings, const std::vector<Summary>& generations) {
  if (generations.empty()) return false;
  double spring_evaluations = 0, seconds = 0;
  for (const Summary& summary : generations) {
    spring_evaluations += static_cast<double>(summary.spring_evaluations);
    seconds += summary.wall_time;
  }
  const auto is_spent = [](double limit, double spent) { return limit > 0 && spent >= limit; };
  return generations.back().evaluations >= settings.evaluations ||
         is_spent(settings.spring_evaluations, spring_evaluations) || is_spent(settings.hours * 3600, seconds);
}

bool is_verified(const Archive& archive, const Settings& settings) {
  const auto best = archive.best(static_cast<std::size_t>(settings.verify));
  return std::ranges::all_of(best, [&](std::uint32_t id) { return archive.verification(id).has_value(); });
}

namespace {

struct TimeEntry {
  const char* key;  ///< of the entry in the run's record
  double& (*of)(TimeSpent& time);
};

constexpr TimeEntry time_entries[] = {
    {"seconds", [](TimeSpent& time) -> double& { return time.whole; }},
    {"seconds_breed", [](TimeSpent& time) -> double& { return time.breed; }},
    {"seconds_select", [](TimeSpent& time) -> double& { return time.select; }},
    {"seconds_archive", [](TimeSpent& time) -> double& { return time.archive; }},
    {"seconds_decode", [](TimeSpent& time) -> double& { return time.evaluation.decode; }},
    {"seconds_simulate", [](TimeSpent& time) -> double& { return time.evaluation.simulate; }},
    {"seconds_develop", [](TimeSpent& time) -> double& { return time.evaluation.develop; }},
    {"seconds_verify", [](TimeSpent& time) -> double& { return time.verify; }},
};

}  // namespace

TimeSpent& TimeSpent::operator+=(const TimeSpent& other) {
  TimeSpent added = other;
  for (const TimeEntry& entry : time_entries) entry.of(*this) += entry.of(added);
  return *this;
}

void record_time_spent(Archive& archive, const TimeSpent& time) {
  TimeSpent whole = recorded_time_spent(archive).value_or(TimeSpent());
  whole += time;
  std::map<std::string, std::string> entries;
  for (const TimeEntry& entry : time_entries) entries[entry.key] = to_text(entry.of(whole));
  archive.set_records(entries);
}

std::optional<TimeSpent> recorded_time_spent(const Archive& archive) {
  if (!archive.find_record("seconds")) return std::nullopt;
  TimeSpent time;
  for (const TimeEntry& entry : time_entries) entry.of(time) = archive.find_seconds(entry.key).value_or(0);
  return time;
}

}  // namespace evodevo
