// What ranks read from bytes that are no message.
#include "cluster/wire.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cluster/messages.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

TEST(Wire, RefusesABooleanThatIsNeither) {
  std::string bytes = message::packed(message::Failure{"host", "no such operator", true});
  ASSERT_EQ(bytes.back(), 1);
  bytes.back() = 37;
  try {
    message::unpacked<message::Failure>(bytes);
    FAIL() << "it was read";
  } catch (const WireError& error) {
    EXPECT_THAT(error.what(), testing::naming("37"));
  }
}

/// Returns the message with which the bytes of a message are refused.
template <class Message>
std::string refusal(const std::string& bytes) {
  try {
    message::unpacked<Message>(bytes);
    return "";
  } catch (const WireError& error) {
    return error.what();
  }
}

TEST(Wire, RefusesAValueThatAnEnumerationLacks) {
  std::string job = message::packed(message::Job{7, message::Work::verify, {}});
  char& work = job.at(sizeof(message::Kind) + sizeof(message::Job::number));
  ASSERT_EQ(work, static_cast<char>(message::Work::verify));
  EXPECT_EQ(refusal<message::Job>(job), "");
  ++work;
  EXPECT_THAT(refusal<message::Job>(job), testing::naming(" 3 ", " 3 values"));

  std::string answer = message::packed(message::Answer{7, {{.result = {.status = Status::passive}}}, 0});
  char& status = answer.at(sizeof(message::Kind) + sizeof(message::Answer::job) + sizeof(std::size_t));
  ASSERT_EQ(status, static_cast<char>(Status::passive));
  EXPECT_EQ(refusal<message::Answer>(answer), "");
  status = '\xff';
  EXPECT_THAT(refusal<message::Answer>(answer), testing::naming(" 255 ", " 5 values"));
}

TEST(Wire, RefusesAMessageOfAnUnknownKind) {
  EXPECT_EQ(message::kind_of(message::packed(message::Kind::stop)), message::Kind::stop);
  const auto next = static_cast<message::Kind>(static_cast<std::uint8_t>(message::Kind::stop) + 1);
  EXPECT_THROW(message::kind_of(message::packed(next)), WireError);
}

TEST(Wire, RefusesMoreValuesThanThereAreBytes) {
  std::string bytes = message::packed(message::End{{2, 3, 5}});
  const std::uint64_t count = (std::uint64_t{1} << 62) + 3;
  std::memcpy(bytes.data() + sizeof(message::Kind), &count, sizeof count);
  EXPECT_THROW(message::unpacked<message::End>(bytes), WireError);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
