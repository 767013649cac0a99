// The end of a run by the clock.
#pragma once

#include <chrono>
#include <string>

namespace evodevo {

/// The time at which this process has to be done, and the decision when to begin no further generation.
///
///   begin ── generations ── no further one fits ── verification, page ── end
///                                          └──────── reserve ─────────────┘
///
/// A tenth of the time, at most half an hour, is the reserve for verification and the page. If a generation takes
/// longer than all before it, it may use up the reserve, and even the time after the end, because it is not cut off.
class TimeLimit {
 public:
  using Clock = std::chrono::steady_clock;

  /// Throws std::invalid_argument unless `begin` is before `end`.
  TimeLimit(Clock::time_point begin, Clock::time_point end);

  /// Notes that a generation took `seconds` and has ended at `now`. From the moment at which another one as long as the
  /// longest would not end before the reserve, is_reached() is true.
  void generation_done(double seconds, Clock::time_point now);
  bool is_reached() const { return is_reached_; }
  Clock::time_point end() const { return end_; }

 private:
  Clock::time_point end_, last_generation_end_;
  double longest_ = 0;  ///< generation, s
  bool is_reached_ = false;
};

/// Returns the end that the option --until gives: a duration from now, such as "90m" or "11.5h" (s, m, h, d), or a
/// local time, such as "2026-11-24T18:30". Throws UsageError if it is neither, or if it
/// is less than a second away.
TimeLimit::Clock::time_point end_given_by(const std::string& text);

}  // namespace evodevo
