// Files that are written completely or not at all.
#include "base/output_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string content(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Returns the message of the exception that `write` throws.
template <class Write>
std::string failure(const Write& write) {
  try {
    write();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

class OutputFiles : public ::testing::Test {
 protected:
  testing::Scratch scratch_;

  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(scratch_ / ""), fs::directory_iterator()));
  }
};

TEST_F(OutputFiles, APartNeverTakesTheName) {
  const fs::path file = scratch_.write("päge (1).html", "old");
  {
    OutputFile output(file, "--out");
    output.write("half of the ");
    EXPECT_EQ(content(file), "old");
  }
  EXPECT_EQ(content(file), "old");
  EXPECT_EQ(files(), 1u) << "what was not finished is gone";
  OutputFile output(file, "--out");
  output.write("new");
  output.finish();
  EXPECT_EQ(content(file), "new");
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFiles, ALinkAndItsPermissionsStay) {
  const fs::path file = scratch_.write("there", "old"), link = scratch_ / "link";
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(file, link);
  write_file(link, "new");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(content(file), "new");
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(OutputFiles, ALinkToNothingGetsItsFile) {
  fs::create_symlink(scratch_ / "there", scratch_ / "link");
  write_file(scratch_ / "link", "new");
  EXPECT_TRUE(fs::is_symlink(scratch_ / "link"));
  EXPECT_EQ(content(scratch_ / "there"), "new");
}

TEST_F(OutputFiles, AFullDeviceIsSaidAndStaysADevice) {
  fs::create_symlink("/dev/full", scratch_ / "full.html");
  for (const std::size_t size : {1u, 100'000u})
    for (const fs::path& file : {fs::path("/dev/full"), scratch_ / "full.html"}) {
      const std::string said = failure([&] { write_file(file, std::string(size, 'x')); });
      EXPECT_THAT(said, AllOf(HasSubstr(file.string()), HasSubstr("No space left on device"))) << size;
    }
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFiles, WhereNothingCanBeTheCauseIsNamed) {
  EXPECT_THAT(failure([&] { OutputFile(scratch_ / "no folder" / "x", "--out x"); }),
              AllOf(HasSubstr("--out x: "), HasSubstr("No such file or directory")));
  EXPECT_THAT(failure([&] { OutputFile(scratch_ / "", "--out x"); }), HasSubstr("Is a directory"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
