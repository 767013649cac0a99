// A message between ranks.
#include "cluster/messages.hpp"

#include "cluster/wire.hpp"
#include "fuzz/target.hpp"

namespace evodevo {
namespace {

using namespace message;

/// Reads the message if it is of this kind. What was read is written and read again without a change.
template <class Message>
void read_as(const std::string& bytes) {
  if (kind_of(bytes) != Message::kind) return;
  const std::string written = packed(unpacked<Message>(bytes));
  require(packed(unpacked<Message>(written)) == written, "a message that was written reads back as another one");
}

template <class... Messages>
void read_as_any(const std::string& bytes) {
  (read_as<Messages>(bytes), ...);
}

}  // namespace

void fuzz(std::string_view input) {
  const std::string bytes(input);
  try {
    protocol_of(bytes);
  } catch (const WireError&) {
  }
  try {
    read_as_any<Setup, Hello, Job, Answer, Beat, End, Failure, Lead, Generation, Done, Migrants, LastMigrants>(bytes);
  } catch (const WireError&) {
  }
}

}  // namespace evodevo
