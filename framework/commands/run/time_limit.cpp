#include "commands/run/time_limit.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <ctime>
#include <optional>
#include <stdexcept>

#include "base/text.hpp"
#include "commands/shell/options.hpp"

namespace evodevo {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr double reserved_share = 0.1;
constexpr Seconds most_reserve = std::chrono::minutes(30);
constexpr double shortest_duration = 1;                      // s, which is what alarms are exact to
constexpr double longest_duration = 10 * 365.0 * 24 * 3600;  // s; longer ones do not fit in all clocks

/// Reads a duration such as "90m", s.
std::optional<double> duration_in(const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || text.data() + text.size() - end != 1) return std::nullopt;
  switch (*end) {
    case 's':
      return number;
    case 'm':
      return number * 60;
    case 'h':
      return number * 3600;
    case 'd':
      return number * 24 * 3600;
    default:
      return std::nullopt;
  }
}

/// Reads a local time such as "2026-11-24T18:30" or "2026-11-24T18:30:15", and returns how long it is until then, s.
std::optional<double> time_until(const std::string& text) {
  for (const char* format : {"%Y-%m-%dT%H:%M:%S", "%Y-%m-%dT%H:%M"}) {
    std::tm read{};
    read.tm_isdst = -1;  // unknown
    const char* end = strptime(text.c_str(), format, &read);
    if (end == nullptr || *end != '\0') continue;
    const int month = read.tm_mon, day = read.tm_mday;
    const std::time_t moment = std::mktime(&read);
    if (moment == std::time_t{-1} || read.tm_mon != month || read.tm_mday != day) return std::nullopt;  // no such day
    return Seconds(std::chrono::system_clock::from_time_t(moment) - std::chrono::system_clock::now()).count();
  }
  return std::nullopt;
}

}  // namespace

TimeLimit::TimeLimit(Clock::time_point begin, Clock::time_point end) : last_generation_end_(end) {
  if (!(begin < end)) throw std::invalid_argument("a time limit that ends before it begins");
  end_ = end;
  const Seconds reserve = std::min<Seconds>(reserved_share * Seconds(end - begin), most_reserve);
  last_generation_end_ -= std::chrono::duration_cast<Clock::duration>(reserve);
}

void TimeLimit::generation_done(double seconds, Clock::time_point now) {
  longest_ = std::max(longest_, seconds);
  if (now + Seconds(longest_) > last_generation_end_) is_reached_ = true;
}

TimeLimit::Clock::time_point end_given_by(const std::string& text) {
  std::optional<double> seconds = duration_in(text);
  if (!seconds) seconds = time_until(text);
  if (!seconds || !(*seconds >= shortest_duration && *seconds <= longest_duration))
    throw UsageError(
        "--until " + printable(text) +
        ": expected a duration of a second or more, such as 90m, 11.5h or 2d, or a local time in the future, such as "
        "2030-01-31T18:30");
  return TimeLimit::Clock::now() + std::chrono::duration_cast<TimeLimit::Clock::duration>(Seconds(*seconds));
}

}  // namespace evodevo
