// The context of operator calls, and changes of process state that operators leave behind.
#include "operators/operator_call.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cfenv>
#include <clocale>
#include <locale>
#include <thread>
#include <vector>

#include "experiment/experiment.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

const OperatorTitle* title(const char* name) { return lasting_title("devo", name, "/a folder (1)/ö.evodevo.so"); }

TEST(OperatorCall, NamesAllThatIsKnown) {
  EXPECT_EQ(text_of({title("erosion"), {.individual = 5, .cycle = 3}, 7}),
            "devo operator \"erosion\" of /a folder (1)/ö.evodevo.so, individual 5, cycle 3, seed 7");
  EXPECT_EQ(text_of({title("erosion"), {.individual = 0}}),
            "devo operator \"erosion\" of /a folder (1)/ö.evodevo.so, individual 0");
  EXPECT_EQ(title("erosion"), title("erosion")) << "it lasts, and there is one";
}

TEST(OperatorCall, IsKnownWhileItLasts) {
  EXPECT_EQ(current_call().title, nullptr);
  in_operator({title("outer"), {.individual = 1}}, [&] {
    in_operator({title("inner")}, [&] { EXPECT_EQ(current_call().title, title("inner")); });
    EXPECT_EQ(current_call().title, title("outer"));
    EXPECT_EQ(current_call().subject.individual, 1);
  });
  EXPECT_EQ(current_call().title, nullptr);
  EXPECT_THROW(in_operator({title("throws")}, [] { throw 7; }), std::runtime_error);
  EXPECT_EQ(current_call().title, nullptr);
}

TEST(OperatorCall, IsSeenByOtherThreads) {
  std::vector<std::string> seen;
  std::vector<std::uint64_t> numbers;
  const auto look = [&] {
    std::thread([&] {
      for_each_call([&](const void*, std::uint64_t number, const OperatorCall& call) {
        seen.push_back(text_of(call));
        numbers.push_back(number);
      });
    }).join();
  };
  const OperatorCall call{title("erosion"), {.individual = 5}, 7};
  look();
  EXPECT_TRUE(seen.empty());
  in_operator(call, [&] { look(), look(); });
  in_operator(call, look);
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(seen[0], text_of(call));
  EXPECT_EQ(numbers[0], numbers[1]) << "it is one call";
  EXPECT_NE(numbers[1], numbers[2]) << "it is another";
}

/// Returns the message about an operator that changes process state.
std::string said_of(const char* name, void (*change)()) {
  ::testing::internal::CaptureStderr();
  in_operator({title(name)}, change);
  in_operator({title(name)}, change);
  return ::testing::internal::GetCapturedStderr();
}

TEST(OperatorCall, WhatItChangesForAllIsPutBackAndNamedOnce) {
  const auto expect_named_once = [&](const char* name, const std::string& what, void (*change)()) {
    const std::string said = said_of(name, change);
    EXPECT_THAT(said, testing::at_place("warning: " + title(name)->whole + ": ", what, "remove"));
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  };
  const std::string locale_before = std::setlocale(LC_ALL, nullptr);
  expect_named_once("rounds", "the rounding mode", [] { std::fesetround(FE_TOWARDZERO); });
  EXPECT_EQ(std::fegetround(), FE_TONEAREST);
  expect_named_once("sets locale", "the locale", [] { std::setlocale(LC_ALL, "C.UTF-8"); });
  EXPECT_EQ(std::setlocale(LC_ALL, nullptr), locale_before);
  expect_named_once("sets C++ locale", "the locale", [] { std::locale::global(std::locale("C.UTF-8")); });
  EXPECT_EQ(std::locale(), std::locale::classic());
  static const locale_t other = newlocale(LC_ALL_MASK, "C.UTF-8", nullptr);
  expect_named_once("sets thread's locale", "the locale", [] { uselocale(other); });
  EXPECT_EQ(uselocale(nullptr), LC_GLOBAL_LOCALE);
#if defined(__x86_64__)
  expect_named_once("flushes", "flush-to-zero", [] { __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040); });
  volatile float small = 1e-38F;
  EXPECT_GT(small / 16, 0);
  expect_named_once("rounds x87", "the rounding mode", [] {
    const unsigned short word = 0x0b7f;
    __asm__ volatile("fldcw %0" : : "m"(word));
  });
#endif
  EXPECT_EQ(said_of("behaves", [] { std::feraiseexcept(FE_INEXACT); }), "");
}

/// Every call of an experiment's operators states its operator, individual, cycle and seed.
TEST(OperatorCall, KnowsWhoseLifeItIs) {
  const Experiment experiment = testing::read(testing::small_experiment);
  const auto asked =
      call_operator(experiment.call_of(Devo::kind, 0, {.individual = 3, .cycle = 2}), [] { return current_call(); });
  EXPECT_THAT(text_of(asked),
              ::testing::MatchesRegex("devo operator \"spring-turnover\" of .*, individual 3, cycle 2, seed 7"));
  try {
    call_operator(experiment.call_of(Fitness::kind, 1, {.individual = 3}), [] { throw 7; });
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::naming("individual 3, seed 7: ", "std::exception", "correct the operator"));
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
