// Work in a child process: whatever happens there, the parent process continues.
#include "operators/isolation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

constexpr unsigned seconds = 60;

TEST(Isolation, GivesWhatTheWorkReturns) {
  const std::string with_zeros("a\0b\0", 4), large(3'000'000, 'x');
  EXPECT_EQ(in_child([&] { return with_zeros; }, seconds).text, with_zeros);
  EXPECT_EQ(in_child([&] { return large; }, seconds).text, large);
  EXPECT_EQ(in_child([] { return std::string(); }, seconds).crash, "");
}

TEST(Isolation, SaysHowAProcessEnded) {
  const auto crash = [](void (*work)()) {
    return in_child([&] { return work(), std::string("done"); }, seconds).crash;
  };
  EXPECT_EQ(crash([] { std::raise(SIGSEGV); }), "Segmentation fault");
  EXPECT_THAT(crash([] { std::exit(0); }), testing::naming("exit code 0"));
  EXPECT_THAT(crash([] { _exit(7); }), testing::naming("exit code 7"));
  EXPECT_EQ(crash([] { std::abort(); }), "Aborted");
}

TEST(Isolation, NothingUnwindsIntoTheParentsCode) {
  const pid_t parent = getpid();
  const auto crash = [&](const std::function<void()>& work) {
    const ChildEnd end = in_child([&] { return work(), std::string("done"); }, seconds);
    EXPECT_EQ(getpid(), parent) << "a child has come back";
    return end.crash;
  };
  EXPECT_THAT(crash([] { throw std::runtime_error("no licence"); }), testing::naming("\"no licence\""));
  EXPECT_THAT(crash([] { throw 7; }), testing::naming("std::exception"));
  EXPECT_NE(crash([] { pthread_exit(nullptr); }), "");
}

TEST(Isolation, EndsWhatDoesNotEndByItself) {
  const ChildEnd end = in_child(
      []() -> std::string {
        alarm(0);
        std::signal(SIGTERM, SIG_IGN);
        while (true) pause();
      },
      1);
  EXPECT_TRUE(end.timed_out);
  EXPECT_THAT(end.crash, testing::naming("1 s"));
}

TEST(Isolation, WaitsForNoProcessThatAChildLeavesBehind) {
  const testing::Scratch scratch;
  const auto leave_one_behind = [&] {
    const pid_t left = fork();
    if (left == 0) {
      setpgid(0, 0);  // so that this process is not killed together with the child
      while (access((scratch / "").c_str(), F_OK) == 0) usleep(1000);
      _exit(0);
    }
    return std::to_string(left);
  };
  // the process left behind keeps the pipe open; in_child() must not wait for it
  const ChildEnd end = in_child(leave_one_behind, seconds);
  EXPECT_NE(end.text, "");
}  // the removal of the folder ends the process left behind

TEST(Isolation, WritesNothingTwice) {
  const testing::Scratch scratch;
  std::FILE* file = std::fopen((scratch / "lines").c_str(), "w");
  std::fputs("once\n", file);  // stays in the buffer, which the child inherits
  in_child([] { return std::exit(0), std::string(); }, seconds);
  in_child([] { return std::string(); }, seconds);
  std::fclose(file);
  std::ifstream stream(scratch / "lines");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "once\n");
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
