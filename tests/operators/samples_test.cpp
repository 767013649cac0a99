// What fitness operators read of samples, and may not read.
#include "evodevo/samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/channels.hpp"
#include "support/messages.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Two samples, 0.25 s apart, of a body of two masses and one spring. A third mass comes in between.
class TwoSamples : public ::testing::Test {
 protected:
  TwoSamples() {
    Body body{.masses = {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}}, .springs = {{0, 1, 1, 0}}, .materials = {{100, 0, 0, 0}}};
    const auto before = std::make_shared<BodyVersion>(BodyVersion{body, {4, 7}});
    body.masses.push_back({{0, 1, 0}, 1});
    const auto after = std::make_shared<BodyVersion>(BodyVersion{body, {4, 7, 9}});
    stored_ = {{.time = 3,
                .centre = {1, 2, 3},
                .velocity = {0.1, 0, 0},
                .box = {{0, 0, 0}, {1, 1, 1}},
                .contact_time = 0.5,
                .work = 7,
                .positions = {0, 0, 0, 1, 0, 0},
                .velocities = {1, 2, 3, 4, 5, 6},
                .contact_times = {0.5, 0.5},
                .forces = {-2},
                .version = before},
               {.time = 3.25,
                .centre = {1, 2, 4},
                .velocity = {0.2, 0, 0},
                .box = {{0, 0, 0}, {2, 1, 1}},
                .contact_time = 0.625,
                .work = 10,
                .positions = {0, 0, 1, 1, 0, 1, 0, 1, 0},
                .velocities = {1, 2, 3, 4, 5, 6, 7, 8, 9},
                .contact_times = {0.5, 0.75, 0.0625},
                .forces = {3},
                .version = after}};
  }

  Samples seen(const Channels& channels) const { return {{&stored_[0], &stored_[1]}, channels}; }

  std::vector<StoredSample> stored_;
};

TEST_F(TwoSamples, CountTimeWorkAndContactFromTheWindowOrTheSampleBefore) {
  const Samples samples = seen(all_channels);
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples.time(0), 0);
  EXPECT_EQ(samples.time(1), 0.25);
  EXPECT_EQ(samples.centre(1).z, 4);
  EXPECT_EQ(samples.velocity(1).x, 0.2);
  EXPECT_EQ(samples.box(1).high.x, 2);
  EXPECT_EQ(samples.work(0), 0);
  EXPECT_EQ(samples.work(1), 3);
  EXPECT_EQ(samples.contact(0), 0);
  EXPECT_EQ(samples.contact(1), 0.5) << "0.125 s of 0.25 s";
  EXPECT_FALSE(samples.edited(0));
  EXPECT_TRUE(samples.edited(1));
  EXPECT_EQ(samples.body(0).masses.size(), 2u);
  EXPECT_EQ(samples.numbers(1).back(), 9u);
  EXPECT_EQ(samples.position(1, 2).y, 1);
  EXPECT_EQ(samples.velocity(0, 1).z, 6);
  EXPECT_EQ(samples.force(0, 0), -2);
  EXPECT_EQ(samples.contact(0, 1), 0);
  EXPECT_EQ(samples.contact(1, 0), 0);
  EXPECT_EQ(samples.contact(1, 1), 1);
  EXPECT_EQ(samples.contact(1, 2), 0.25) << "of the mass that came";
}

std::string refusal(const std::function<void()>& read) {
  try {
    read();
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "nothing";
}

TEST_F(TwoSamples, RefuseWhatNobodyAskedFor) {
  const struct {
    std::string name;
    bool Channels::*channel;
    std::function<void(const Samples&)> read;
  } all[] = {
      {"centre", &Channels::centre, [](const Samples& s) { s.centre(0); }},
      {"centre", &Channels::centre, [](const Samples& s) { s.velocity(0); }},
      {"box", &Channels::box, [](const Samples& s) { s.box(0); }},
      {"contact", &Channels::contact, [](const Samples& s) { s.contact(1); }},
      {"work", &Channels::work, [](const Samples& s) { s.work(1); }},
      {"positions", &Channels::positions, [](const Samples& s) { s.position(0, 0); }},
      {"velocities", &Channels::velocities, [](const Samples& s) { s.velocity(0, 0); }},
      {"contacts", &Channels::contacts, [](const Samples& s) { s.contact(1, 0); }},
      {"forces", &Channels::forces, [](const Samples& s) { s.force(0, 0); }},
  };
  for (const auto& [name, channel, read] : all) {
    Channels others = all_channels;
    others.*channel = false;
    EXPECT_THAT(refusal([&] { read(seen(others)); }), testing::naming("\"" + name + "\"", "Request::channels." + name));
    Channels alone;
    alone.*channel = true;
    EXPECT_EQ(refusal([&] { read(seen(alone)); }), "nothing") << name;
  }
  const Samples of_the_whole = seen({.centre = true, .box = true, .contact = true, .work = true});
  EXPECT_THAT(refusal([&] { of_the_whole.body(0); }), testing::naming("body", "Request::channels"));
  EXPECT_THAT(refusal([&] { of_the_whole.numbers(0); }), testing::naming("body", "Request::channels"));
  EXPECT_EQ(refusal([&] { seen({.forces = true}).body(0); }), "nothing");
}

TEST_F(TwoSamples, RefuseWhatIsNotThere) {
  const Samples samples = seen(all_channels);
  EXPECT_THAT(refusal([&] { samples.time(2); }), testing::naming("sample 2", "only 2"));
  EXPECT_THAT(refusal([&] { samples.centre(2); }), testing::naming("sample 2", "only 2"));
  EXPECT_THAT(refusal([&] { samples.position(0, 2); }), testing::naming("mass 2", "only 2"));
  EXPECT_THAT(refusal([&] { samples.velocity(1, 3); }), testing::naming("mass 3", "only 3"));
  EXPECT_THAT(refusal([&] { samples.contact(0, 2); }), testing::naming("mass 2", "only 2"));
  EXPECT_THAT(refusal([&] { samples.force(1, 1); }), testing::naming("spring 1", "only 1"));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
