// How text from outside is escaped in messages, tables and JSON.
#include "base/text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/json_text.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

TEST(Printable, KeepsTextAsItIs) {
  for (const char* text : {"", "dt = 0.0007", "Größe (µm), 体 and 🦎", "C:\\new \"quoted\" \\n"}) {
    EXPECT_EQ(printable(text), text);
    EXPECT_EQ(text_fault(text), "");
  }
}

TEST(Printable, EscapesWhatDisturbsATerminalOrALine) {
  EXPECT_EQ(printable("a\nb\r\tc"), "a\\nb\\r\\tc");
  EXPECT_EQ(printable("\x1b[31mred\x07\x7f"), "\\x1b[31mred\\x07\\x7f");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\u009b31m\u0085"), "\\u009b31m\\u0085") << "controls of two bytes";
  EXPECT_EQ(printable("\u2028\u202e\u2066"), "\\u2028\\u202e\\u2066");
  EXPECT_EQ(printable("\u00a0\u200d\u202f"), "\u00a0\u200d\u202f") << "their harmless neighbours";
  EXPECT_EQ(printable(printable("\x1b\n\xff")), printable("\x1b\n\xff"));
}

TEST(Printable, EscapesWhatIsNoUtf8) {
  EXPECT_EQ(printable("a\xff"
                      "b"),
            "a\\xffb");
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
  std::string umlauts;
  for (int i = 0; i < 100; ++i) umlauts += "ä";
  EXPECT_EQ(printable(umlauts, 12), "ääää...") << "not half an ä";
  EXPECT_EQ(printable("abcd\x1b\x1b\x1b", 10), "abcd...") << "not half an escape";
  EXPECT_LE(printable(std::string(1'000'000, '\x01')).size(), 300u);
}

TEST(Printable, SaysWhyATextCanBeNoName) {
  EXPECT_THAT(text_fault("a\x1b"), testing::at_place("\"a\\x1b\" ", "300 bytes", "UTF-8", "control characters"));
  EXPECT_NE(text_fault(std::string(301, 'a')), "");
  EXPECT_EQ(text_fault(std::string(300, 'a')), "");
}

TEST(Suggestion, IsQuickForWordsOfAnyLength) {
  const std::vector<std::string> known{"seed", "population", "random_individuals", "evaluations"};
  EXPECT_EQ(nearest(std::string(10'000'000, 's'), known), "");
  EXPECT_EQ(nearest("populatoin", known), "population");
}

TEST(JsonText, IsJsonWithoutControlCharacters) {
  const nlohmann::ordered_json json{{"name", "\x1b\x7f\u0080\u009bÄ\u00a0\xff\n"}};
  const std::string text = json_text(json);
  EXPECT_EQ(text, "{\n \"name\": \"\\u001b\\u007f\\u0080\\u009bÄ\u00a0\ufffd\\n\"\n}");
  EXPECT_EQ(nlohmann::json::parse(text).at("name"), "\x1b\x7f\u0080\u009bÄ\u00a0\ufffd\n");
}

TEST(JsonText, IsOneLineIfAskedForWhateverALineIs) {
  const nlohmann::ordered_json json{{"name", "a\u2027\u2028\u2029\u202ab\u0085\n"}};
  const std::string text = json_text(json, -1);
  EXPECT_EQ(text, "{\"name\":\"a\u2027\\u2028\\u2029\u202ab\\u0085\\n\"}");
  EXPECT_EQ(nlohmann::ordered_json::parse(text), json);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
