// What ranks read from bytes that are no message.
#include "cluster/wire.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cluster/messages.hpp"
#include "support/messages.hpp"

namespace evodevo {
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

TEST(Wire, RefusesMoreValuesThanThereAreBytes) {
  std::string bytes = message::packed(message::End{{2, 3, 5}});
  const std::uint64_t count = (std::uint64_t{1} << 62) + 3;
  std::memcpy(bytes.data() + sizeof(message::Kind), &count, sizeof count);
  EXPECT_THROW(message::unpacked<message::End>(bytes), WireError);
}

}  // namespace
}  // namespace evodevo
