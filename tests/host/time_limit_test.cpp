// When a run with a time limit begins no further generation.
#include "commands/run/time_limit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "commands/shell/command.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using namespace std::chrono_literals;
using Clock = TimeLimit::Clock;

const Clock::time_point begin = Clock::now();

TEST(TimeLimit, IsReachedWhenAnotherGenerationWouldNotLeaveTheReserve) {
  TimeLimit limit(begin, begin + 100s);  // the last generation has to end after 90 s
  limit.generation_done(7, begin + 7s);
  limit.generation_done(11, begin + 78s);
  EXPECT_FALSE(limit.is_reached()) << "89 s";
  limit.generation_done(1, begin + 79500ms);
  EXPECT_TRUE(limit.is_reached()) << "the longest of all counts: 90.5 s";
  EXPECT_EQ(limit.end(), begin + 100s);
}

TEST(TimeLimit, ReservesHalfAnHourAtMost) {
  TimeLimit limit(begin, begin + 10h);
  limit.generation_done(60, begin + 9h + 28min);
  EXPECT_FALSE(limit.is_reached());
  limit.generation_done(60, begin + 9h + 29min + 1s);
  EXPECT_TRUE(limit.is_reached());
}

TEST(TimeLimit, StaysReached) {
  TimeLimit limit(begin, begin + 100s);
  limit.generation_done(0.5, begin + 95s);
  limit.generation_done(0.5, begin + 3s);
  EXPECT_TRUE(limit.is_reached());
}

TEST(TimeLimit, IsADurationOrALocalTime) {
  const auto seconds_until = [](const std::string& text) {
    const Clock::time_point before = Clock::now();
    const Clock::time_point end = end_given_by(text);
    const auto seconds = [&](Clock::time_point time) { return std::chrono::duration<double>(time - before).count(); };
    return std::pair(seconds(end), seconds(Clock::now()));
  };
  for (const auto& [text, seconds] : {std::pair("75s", 75.0), {"1.5m", 90.0}, {"0.25h", 900.0}, {"2d", 172800.0}}) {
    const auto [until, elapsed] = seconds_until(text);
    EXPECT_GE(until, seconds - 1e-6) << text;
    EXPECT_LE(until, seconds + elapsed + 1e-6) << text;
  }
  const std::time_t tomorrow = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now() + 24h);
  std::tm local{};
  localtime_r(&tomorrow, &local);
  for (const auto& [format, seconds] : {std::pair("%Y-%m-%dT%H:%M", 60.0), {"%Y-%m-%dT%H:%M:%S", 1.0}}) {
    char text[32];
    ASSERT_GT(std::strftime(text, sizeof text, format, &local), 0u);
    const auto [until, elapsed] = seconds_until(text);
    EXPECT_GT(until, 24 * 3600.0 - 2 * seconds - elapsed) << text;
    EXPECT_LE(until, 24 * 3600.0 + elapsed) << text;
  }
}

TEST(TimeLimit, RefusesWhatIsNoTimeInTheFuture) {
  for (const std::string text :
       {"", "90", "m", "-5m", "0s", "0.9s", "1e-12h",
        "nan"
        "h",
        "infh", "1e99d", "90 m", "5x", "2001-02-03T04:05", "2030-13-01T00:00", "tomorrow", "2030-01-31"}) {
    try {
      end_given_by(text);
      ADD_FAILURE() << text;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), testing::at_place("--until " + text + ": ", "90m", "T18:30"));
    }
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
