// How text from outside is escaped in messages, tables and JSON, the format of numbers, and what ranks read from bytes
// that are no message.
#include "base/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/json_text.hpp"
#include "cluster/messages.hpp"
#include "cluster/wire.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

TEST(Printable, KeepsTextAsItIs) {
  for (const char* text : {"", "dt = 0.0007", "Größe (µm), 体 and 🦎", "C:\\new \"quoted\" \\n"}) {
    EXPECT_EQ(printable(text), text);
    EXPECT_EQ(text_fault(text), "");
  }
}

TEST(Printable, EscapesWhatDisturbsATerminalOrALineAndWhatIsNoUtf8) {
  EXPECT_EQ(printable("a\nb\r\tc"), "a\\nb\\r\\tc");
  EXPECT_EQ(printable("\x1b[31mred\x07\x7f"), "\\x1b[31mred\\x07\\x7f");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\u009b31m\u0085"), "\\u009b31m\\u0085") << "controls of two bytes";
  EXPECT_EQ(printable("\u2028\u202e\u2066"), "\\u2028\\u202e\\u2066");
  EXPECT_EQ(printable("\u00a0\u200d\u202f"), "\u00a0\u200d\u202f") << "their harmless neighbours";
  EXPECT_EQ(printable(printable("\x1b\n\xff")), printable("\x1b\n\xff"));
  EXPECT_EQ(printable("a\xffz"), "a\\xffz");
  EXPECT_EQ(printable("\xc3"), "\\xc3") << "half a character";
  EXPECT_EQ(printable("\xc3("), "\\xc3(");
  EXPECT_EQ(printable("\xc0\x8a"), "\\xc0\\x8a") << "a newline in too many bytes";
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half a pair of UTF-16";
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond Unicode";
  EXPECT_EQ(printable("\xf0\x9f\xa6"), "\\xf0\\x9f\\xa6");
}

TEST(Printable, CutsWhatIsTooLongBetweenCharacters) {
  EXPECT_EQ(printable("0123456789", 10), "0123456789");
  EXPECT_EQ(printable("0123456789a", 10), "0123456...");
  EXPECT_EQ(printable("ääääääääää", 12), "ääää...") << "not half an ä";
  EXPECT_EQ(printable("abcd\x1b\x1b\x1b", 10), "abcd...") << "not half an escape";
  EXPECT_LE(printable(std::string(1'000'000, '\x01')).size(), 300u);
}

TEST(Printable, SaysWhyATextCanBeNoName) {
  EXPECT_THAT(text_fault("a\x1b"), testing::at_place("\"a\\x1b\" ", "300 bytes", "UTF-8", "control characters"));
  EXPECT_NE(text_fault(std::string(301, 'a')), "");
  EXPECT_EQ(text_fault(std::string(300, 'a')), "");
}

TEST(ShellWord, ReachesAProgramUnchanged) {
  for (const std::string word : {"runs/a-1", "", "my robot", "it's", "$HOME `x` \\ \"q\"", "*", "a\nb\x1b[0m", "\u00e9",
                                 "\xff", "-n", "~", "a;b"}) {
    FILE* shell = popen(("bash -c " + shell_word("printf %s " + shell_word(word))).c_str(), "r");
    ASSERT_NE(shell, nullptr);
    std::string said(100, '\0');
    said.resize(std::fread(said.data(), 1, said.size(), shell));
    EXPECT_EQ(pclose(shell), 0);
    EXPECT_EQ(said, word);
    EXPECT_EQ(printable(shell_word(word)), shell_word(word)) << "it disturbs no terminal";
  }
  EXPECT_EQ(shell_word("runs/a_b-1.x"), "runs/a_b-1.x") << "it stays as it is if it can";
}

TEST(Suggestion, IsQuickForWordsOfAnyLength) {
  const std::vector<std::string> known{"seed", "population", "random_individuals", "evaluations"};
  EXPECT_EQ(nearest(std::string(10'000'000, 's'), known), "");
  EXPECT_EQ(nearest("populatoin", known), "population");
}

TEST(JsonText, IsJsonWithoutControlCharactersAndOneLineIfAskedFor) {
  const std::string text = json_text({{"name", "\x1b\x7f\u0080\u009bÄ\u00a0\xff\n"}});
  EXPECT_EQ(text, "{\n \"name\": \"\\u001b\\u007f\\u0080\\u009bÄ\u00a0\ufffd\\n\"\n}");
  EXPECT_EQ(nlohmann::json::parse(text).at("name"), "\x1b\x7f\u0080\u009bÄ\u00a0\ufffd\n");
  const nlohmann::ordered_json json{{"name", "a\u2027\u2028\u2029\u202ab\u0085\n"}};
  const std::string line = json_text(json, -1);
  EXPECT_EQ(line, "{\"name\":\"a\u2027\\u2028\\u2029\u202ab\\u0085\\n\"}");
  EXPECT_EQ(nlohmann::ordered_json::parse(line), json);
}

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Numbers, ReadBackAsTheSame) {
  for (const double value :
       {0.0, 3.0, -17.0, 0.1, 0.1 + 0.2, 0.0007, 1e-9, 1e300, -5e-324, 123456789.125, 1e15, 0x1p63})
    EXPECT_EQ(std::strtod(to_text(value).c_str(), nullptr), value) << to_text(value);
  EXPECT_EQ(to_text(3.0), "3");
  EXPECT_EQ(to_text(0.0007), "0.0007");
  EXPECT_EQ(to_text(-0.0), "0");
}

TEST(Numbers, ThatAreNotFiniteAreToldAndInShortTheyHaveFourDigits) {
  for (const double value : {nan, -nan}) {
    EXPECT_EQ(to_text(value), "not a number");
    EXPECT_EQ(short_number(value), "not a number");
  }
  EXPECT_EQ(to_text(infinity), "infinity");
  EXPECT_EQ(short_number(-infinity), "-infinity");
  EXPECT_EQ(short_number(0.123456), "0.1235");
  EXPECT_EQ(short_number(-0.0), "0");
  EXPECT_EQ(short_number(123456789), "1.235e+08");
}

TEST(Numbers, OfARangeAreItsEnds) {
  EXPECT_EQ(to_text(Range{0, 0.5, "s"}), "0 to 0.5");
  EXPECT_EQ(to_text(Range{-1, infinity}), "at least -1");
  EXPECT_EQ(to_text(Range{-infinity, 1e-9}), "at most 1e-09");
  EXPECT_EQ(to_text(Range{}), "");
}

/// Returns the message with which the bytes of a message are refused.
template <class Message>
std::string refusal(const std::string& bytes) {
  return testing::refusal<WireError>([&] { message::unpacked<Message>(bytes); });
}

TEST(Wire, RefusesAValueThatATypeLacks) {
  std::string bytes = message::packed(message::Failure{"host", "no such operator", true});
  ASSERT_EQ(bytes.back(), 1);
  bytes.back() = 37;
  EXPECT_THAT(refusal<message::Failure>(bytes), testing::naming("37"));

  std::string job = message::packed(message::Job{7, message::Work::verify, {}});
  char& work = job.at(sizeof(message::Kind) + sizeof(message::Job::number));
  ASSERT_EQ(work, static_cast<char>(message::Work::verify));
  EXPECT_EQ(refusal<message::Job>(job), "no refusal");
  ++work;
  EXPECT_THAT(refusal<message::Job>(job), testing::naming(" 3 ", " 3 values"));

  std::string answer = message::packed(message::Answer{7, {{.result = {.status = Status::lucky}}}, 0});
  char& status = answer.at(sizeof(message::Kind) + sizeof(message::Answer::job) + sizeof(std::size_t));
  ASSERT_EQ(status, static_cast<char>(Status::lucky));
  EXPECT_EQ(refusal<message::Answer>(answer), "no refusal");
  status = '\xff';
  EXPECT_THAT(refusal<message::Answer>(answer), testing::naming(" 255 ", " 6 values"));
}

TEST(Wire, RefusesAMessageOfAnUnknownKindAndMoreValuesThanThereAreBytes) {
  EXPECT_EQ(message::kind_of(message::packed(message::Kind::stop)), message::Kind::stop);
  const auto next = static_cast<message::Kind>(static_cast<std::uint8_t>(message::Kind::stop) + 1);
  EXPECT_THROW(message::kind_of(message::packed(next)), WireError);

  std::string bytes = message::packed(message::End{{2, 3, 5}});
  const std::uint64_t count = (std::uint64_t{1} << 62) + 3;
  std::memcpy(bytes.data() + sizeof(message::Kind), &count, sizeof count);
  EXPECT_THROW(message::unpacked<message::End>(bytes), WireError);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
