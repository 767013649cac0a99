// The data in pages of the viewer, whose numbers can be unpacked.
#include "report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <atomic>
#include <numbers>
#include <numeric>
#include <random>
#include <set>

#include "analysis/ground.hpp"
#include "evolution/evolution.hpp"
#include "report/film_json.hpp"
#include "report/filming.hpp"
#include "report/packing.hpp"
#include "report/page.hpp"
#include "report/scene_json.hpp"
#include "support/experiments.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;

/// Unpacks a text in the same way as a page.
std::vector<std::int64_t> unpacked(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> deflated, plain(1 << 22);
  std::uint32_t bits = 0, count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    if ((count += 6) >= 8) deflated.push_back(static_cast<unsigned char>(bits >> (count -= 8)));
  }
  uLongf size = plain.size();
  EXPECT_EQ(uncompress(plain.data(), &size, deflated.data(), static_cast<uLong>(deflated.size())), Z_OK);
  std::vector<std::int64_t> numbers;
  std::uint64_t number = 0, shift = 0;
  for (uLongf i = 0; i < size; ++i) {
    number |= static_cast<std::uint64_t>(plain[i] & 0x7f) << shift;
    shift += 7;
    if (plain[i] & 0x80) continue;
    numbers.push_back(static_cast<std::int64_t>(number >> 1) ^ -static_cast<std::int64_t>(number & 1));
    number = shift = 0;
  }
  return numbers;
}

TEST(Packing, KeepsNumbers) {
  const std::vector<std::int64_t> numbers = {0, -1, 1, 63, -64, 64, 8191, -8193, 1'000'000'007, -(1LL << 40)};
  for (std::size_t count = 0; count <= numbers.size(); ++count) {
    const std::vector<std::int64_t> some(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(count));
    EXPECT_EQ(unpacked(packed(some)), some);
  }
}

TEST(Packing, TellsWhatCameAndWent) {
  const std::vector<std::uint32_t> before = {1, 2, 5}, after = {2, 3, 5, 9};
  EXPECT_THAT(unpacked(packed_changes(before, after)), ElementsAre(1, 2, 6));
}

TEST(Packing, TellsValuesByHowTheyDifferFromTheirLast) {
  ValuePacking values(4);
  EXPECT_THAT(unpacked(values.next(std::vector<std::uint32_t>{0, 3}, std::vector<std::int64_t>{7, 9})),
              ElementsAre(7, 9));
  EXPECT_THAT(unpacked(values.next(std::vector<std::uint32_t>{1, 3}, std::vector<std::int64_t>{5, 8})),
              ElementsAre(5, -1));
  EXPECT_THAT(unpacked(values.next(std::vector<std::uint32_t>{0}, std::vector<std::int64_t>{7})), ElementsAre(0));
}

TEST(Packing, TellsPlacesByHowMassesMoved) {
  const Frame a{0, {{1, 2, 3}, {2, 2, 3}}}, b{1, {{2, 2, 3}, {3, 2, 3}}}, c{2, {{4, 2, 3}, {5, 2, 7}}};
  const Frame after{2, {{5, 2, 7}, {6, 2, 7}}};
  const std::vector<const Frame*> frames = {&a, &b, &c}, again = {&after};
  PlacePacking positions(3, 0.5);
  EXPECT_THAT(unpacked(positions.next(frames, std::vector<std::uint32_t>{0, 1})),
              ElementsAre(2, 2, 4, 0, 6, 0, 2, 2, 0, 0, 0, 0, 3, 3, 0, 0, 0, 8));
  // the second mass stays at its position, and a new one is added
  EXPECT_THAT(unpacked(positions.next(again, std::vector<std::uint32_t>{1, 2})), ElementsAre(0, 2, 0, 0, 0, 0));
}

TEST(Packing, PlacesOutOfReachAreAtItsEnd) {
  EXPECT_EQ(whole_steps(-3.3, 0.5), -7);
  for (const double far : {1e6, 1e34, 1e300}) {
    EXPECT_EQ(whole_steps(far, 1e-4), 1 << 29);
    EXPECT_EQ(whole_steps(-far, 1e-4), -(1 << 29));
  }
}

/// A shot of a body with masses at the given x positions, with the given numbers, joined in the given pairs.
Shot shot_of(const std::vector<double>& positions, std::vector<std::uint32_t> numbers,
             const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
  Shot shot;
  shot.body.materials = {{.stiffness = 1}};
  shot.numbers = std::move(numbers);
  Frame& frame = shot.frames.emplace_back();
  for (const double x : positions) {
    shot.body.masses.push_back({.rest = {x, 0, 0}, .mass = 1, .material = 0});
    frame.positions.push_back(seen({x, 0, 0}));
  }
  for (const auto& [a, b] : pairs) shot.body.springs.push_back({a, b, 1, 0});
  shot.stress.assign(pairs.size(), 1.0);
  return shot;
}

TEST(FilmJson, KnowsMassesAndSpringsAgainAfterEdits) {
  // the first mass and its spring are removed, so the indices of the others decrease by one; a new mass and a spring to
  // it are added
  const Film film = {shot_of({0, 1, 2}, {0, 1, 2}, {{0, 1}, {1, 2}}), shot_of({1, 2, 5}, {1, 2, 3}, {{0, 1}, {2, 0}})};
  const auto json = film_json(film, {{"before"}, {"after"}}, 1000);
  EXPECT_EQ(json["masses"], 4);
  EXPECT_THAT(unpacked(json["ends"]), ElementsAre(0, 1, 1, 2, 1, 3));
  EXPECT_THAT(unpacked(json["shots"][0]["masses"]), ElementsAre(0, 1, 1));
  EXPECT_THAT(unpacked(json["shots"][0]["springs"]), ElementsAre(0, 1));
  EXPECT_THAT(unpacked(json["shots"][1]["masses"]), ElementsAre(0, 3));
  EXPECT_THAT(unpacked(json["shots"][1]["springs"]), ElementsAre(0, 2));
}

TEST(FilmJson, TellsParallelSpringsApart) {
  Shot before = shot_of({0, 1, 2}, {0, 1, 2}, {{0, 1}, {1, 2}, {1, 0}}), after = before;
  before.body.materials.push_back({.stiffness = 2});
  before.body.springs[2].material = 1;
  after.body.springs.pop_back();
  after.stress.pop_back();
  const auto json = film_json({before, after}, {{"before"}, {"after"}}, 1000);
  EXPECT_THAT(unpacked(json["ends"]), ElementsAre(0, 1, 1, 2, 0, 1));
  EXPECT_THAT(unpacked(json["shots"][0]["springs"]), ElementsAre(0, 1, 1));
  EXPECT_THAT(unpacked(json["shots"][0]["materials"]), ElementsAre(0, 0, 1));
  EXPECT_THAT(unpacked(json["shots"][1]["springs"]), ElementsAre(2)) << "the one that is gone";
}

TEST(FilmJson, KnowsTheRestLengthsOfEachShot) {
  Shot before = shot_of({0, 1, 2}, {0, 1, 2}, {{0, 1}, {1, 2}}), after = before;
  before.body.springs[0].rest_length = 0.7;
  after.body.springs[0].rest_length = 0.73;
  after.body.springs[1].rest_length = 1.9;
  const auto json = film_json({before, after}, {{"before"}, {"after"}}, 1'000'000);
  const double unit = json["rest_step"];
  EXPECT_LE(unit, json["step"].get<double>() / 4);
  const auto first = unpacked(json["shots"][0]["rest_lengths"]), changes = unpacked(json["shots"][1]["rest_lengths"]);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_NEAR(unit * static_cast<double>(first[s]), before.body.springs[s].rest_length, unit) << s;
    EXPECT_NEAR(unit * static_cast<double>(first[s] + changes[s]), after.body.springs[s].rest_length, unit) << s;
  }
}

TEST(FilmJson, KnowsMaterialsAgainThatABodyHasLost) {
  const Material bone{10000, 0, 0, 0}, muscle{5000, 0.14, 1, 0}, stiffer{10500, 0, 0, 0}, stiffest{11025, 0, 0, 0};
  Shot before = shot_of({0, 1}, {0, 1}, {{0, 1}}), between = before, after = before;
  for (Shot* shot : {&before, &between, &after}) {
    shot->body.materials = {bone, muscle, bone};
    shot->body.base_materials = 3;
    shot->body.springs.front().material = 3;
    shot->body.masses[1].material = 1;
  }
  between.body.materials.push_back(stiffer);
  after.body.materials.push_back(stiffest);
  before.body.springs.front().material = 2;
  const auto json = film_json({before, between, after}, {{"1"}, {"2"}, {"3"}}, 1000);
  ASSERT_EQ(json["materials"].size(), 5u) << "the experiment's first, two of which are equal";
  EXPECT_EQ(json["materials"][1]["stiffness"], muscle.stiffness);
  std::int64_t material = 0;
  for (const auto& [shot, made_of] : {std::pair{0, bone}, {1, stiffer}, {2, stiffest}}) {
    material += unpacked(json["shots"][shot]["materials"]).front();  // stored as the difference from the previous value
    EXPECT_EQ(json["materials"][material]["stiffness"], made_of.stiffness) << shot;
  }
  EXPECT_THAT(unpacked(json["mass_materials"]), ElementsAre(0, 1));
}

/// A shot of `frames` frames with masses in a row that oscillate, each with a frequency of its own.
Shot swinging(std::size_t masses, std::size_t frames) {
  std::vector<double> positions(masses);
  std::vector<std::uint32_t> numbers(masses);
  std::iota(positions.begin(), positions.end(), 0.0);
  std::iota(numbers.begin(), numbers.end(), 0u);
  Shot shot = shot_of(positions, numbers, {{0, 1}});
  shot.frames.clear();
  for (std::size_t f = 0; f < frames; ++f) {
    Frame& frame = shot.frames.emplace_back(Frame{static_cast<double>(f) / filmed_frames_per_second, {}});
    for (const double x : positions) frame.positions.push_back(seen({x, std::sin((1 + x) * frame.time), std::cos(x)}));
  }
  return shot;
}

TEST(FilmJson, LongLivesTakeNoMoreThanTheirBudget) {
  constexpr std::size_t budget = 200'000;
  for (const std::size_t minutes : {1u, 8u}) {
    const auto json = film_json({swinging(40, minutes * 3600 + 1)}, {{"long"}}, budget);
    const auto times = json["shots"][0]["times"].get<std::vector<double>>();
    EXPECT_LT(json.dump().size(), budget + 200);
    EXPECT_GT(json.dump().size(), budget / 2) << "what there is room for is kept";
    EXPECT_EQ(times.front(), 0);
    EXPECT_NEAR(times.back(), 60.0 * static_cast<double>(minutes), 1e-6);
    EXPECT_EQ(unpacked(json["shots"][0]["positions"]).size(), times.size() * 3 * 40);
  }
}

TEST(FilmJson, KeepsTheEndsOfEachShotWhateverTheyTake) {
  const auto json = film_json({swinging(40, 61), swinging(40, 121)}, {{"one"}, {"two"}}, 0);
  EXPECT_EQ(json["shots"][0]["times"], (std::vector<double>{0, 1}));
  EXPECT_EQ(json["shots"][1]["times"], (std::vector<double>{0, 2}));
  EXPECT_GT(json["error"]["largest"].get<double>(), 0.5);
}

TEST(FilmJson, StatesTheErrorOfWhatItLeavesOut) {
  // a mass jumps by 1 m in the middle of an interval of which every other frame is kept
  Shot shot = shot_of({0, 4}, {0, 1}, {{0, 1}});
  for (int i = 1; i <= 4; ++i) {
    shot.frames.push_back(shot.frames.front());
    shot.frames.back().time = i;
  }
  shot.frames[1].positions[0] = {0, 1, 0};
  const auto json = film_json({shot}, {{"jump"}}, 1'000'000);
  EXPECT_EQ(json["shots"][0]["times"], (std::vector<double>{0, 2, 4}));
  EXPECT_NEAR(json["error"]["largest"].get<double>(), 1, 1e-3);
}

/// Applies spring turnover: replaces `springs` random springs with springs between masses that are not joined yet.
void turn_over(Body& body, std::size_t springs, std::mt19937& random) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> joined;
  for (const Spring& spring : body.springs) joined.insert(std::minmax(spring.a, spring.b));
  std::uniform_int_distribution<std::uint32_t> mass(0, static_cast<std::uint32_t>(body.masses.size() - 1));
  std::shuffle(body.springs.begin(), body.springs.end(), random);
  body.springs.resize(body.springs.size() - std::min(springs, body.springs.size()));
  while (springs > 0) {
    const std::uint32_t a = mass(random), b = mass(random);
    if (a == b || !joined.insert(std::minmax(a, b)).second) continue;
    body.springs.push_back({a, b, 1, mass(random) % 4});
    --springs;
  }
}

/// A life as long as those of the paper, with a fifth of the masses and springs. All masses pulse once per second, each
/// with an amplitude of its own and some noise, and drift away; stress differs from shot to shot.
Film long_life(int cycles) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  Shot shot;
  shot.body.materials.resize(4);
  for (std::uint32_t i = 0; i < 200; ++i) {
    shot.body.masses.push_back({.rest = {any(random), any(random), any(random)}, .mass = 0.2, .material = 0});
    shot.numbers.push_back(i);
  }
  turn_over(shot.body, 2500, random);
  Film film;
  double time = 0;
  for (int i = 0; i < cycles + 2; ++i) {
    turn_over(shot.body, i < cycles ? 25 : 0, random);
    shot.stress.clear();
    for (std::size_t s = 0; s < shot.body.springs.size(); ++s) shot.stress.push_back(std::exp(2 * any(random)));
    shot.frames = film.empty() ? std::vector<Frame>{} : std::vector<Frame>{film.back().frames.back()};
    const double duration = i < cycles ? 1 : i == cycles ? 3 : 10;
    for (double t = 0; t < duration + 1e-9; t += 1 / filmed_frames_per_second) {
      if (t == 0 && !film.empty()) continue;
      Frame& frame = shot.frames.emplace_back(Frame{time + t, {}});
      for (const Mass& mass : shot.body.masses) {
        const double pulse = 0.1 * mass.rest.y * std::sin(2 * std::numbers::pi * (frame.time + mass.rest.x));
        frame.positions.push_back(seen(mass.rest + Vec3{0.02 * frame.time, 0.003 * any(random), pulse}));
      }
    }
    time += duration;
    film.push_back(shot);
  }
  return film;
}

TEST(FilmJson, ThirteenLivesOfAHundredCyclesFitIntoAPage) {
  constexpr int cycles = 100;
  constexpr std::size_t budget = page_budget / 13 / 5;  // a page has 10 + 3 lives, five times as large
  const Film film = long_life(cycles);
  std::vector<Title> titles(cycles, {"cycle"});
  titles.insert(titles.end(), {{"settling"}, {"measured", true}});
  const auto json = film_json(film, titles, budget);
  EXPECT_LE(json.dump().size(), budget + 200);  // the error is added after packing
  std::set<std::int64_t> springs;
  for (int i = 0; i < cycles; ++i) {
    const auto& shot = json["shots"][static_cast<std::size_t>(i)];
    EXPECT_GT(shot["times"].size(), 2u) << "between its ends something is seen";
    std::int64_t number = 0;
    for (const std::int64_t difference : unpacked(shot["springs"])) {
      number += difference;
      if (springs.erase(number) == 0) springs.insert(number);
    }
    ASSERT_EQ(springs.size(), film[static_cast<std::size_t>(i)].body.springs.size());
  }
  const double measured = json["shots"].back()["times"].size() / 10.0;  // frames per second
  EXPECT_GE(measured, 3 * static_cast<double>(json["shots"][0]["times"].size() - 1));
  EXPECT_LT(json["stress_levels"], 255) << "or else this life is not long";
}

TEST(FilmJson, StatesTheErrorOfStress) {
  std::vector<double> positions(300);
  std::vector<std::uint32_t> numbers(300);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::iota(positions.begin(), positions.end(), 0.0);
  std::iota(numbers.begin(), numbers.end(), 0u);
  for (std::uint32_t i = 0; i + 1 < 300; ++i) pairs.emplace_back(i, i + 1);
  Shot shot = shot_of(positions, numbers, pairs);
  for (std::size_t s = 0; s < shot.stress.size(); ++s) shot.stress[s] = static_cast<double>(s);
  for (const std::size_t budget : {1'000'000u, 0u}) {
    const auto json = film_json({shot}, {{"one"}}, budget);
    const double most = json["most_stress"], levels = json["stress_levels"], error = json["error"]["stress"];
    const std::vector<std::int64_t> shown = unpacked(json["shots"][0]["stress"]);
    double largest = 0;
    for (std::size_t s = 0; s < shown.size(); ++s) {
      const double part = static_cast<double>(shown[s]) / levels;
      largest = std::max(largest, std::abs(most * part * part - shot.stress[s]));
    }
    EXPECT_LE(largest, error);
    EXPECT_GT(largest, 0.5 * error);
  }
}

/// A filmed life with a single frame, in which the masses are at these positions.
FilmedLife life_at(const std::vector<SeenPlace>& positions, Status status = Status::ok) {
  FilmedLife life;
  life.result.status = status;
  life.film.push_back({{}, {{0, positions}}, {}});
  return life;
}

SeenRegion region_of(const std::vector<FilmedLife>& lives) {
  SeenRegion region;
  for (const FilmedLife& life : lives) region.include({life});  // one by one, as reports do
  return region;
}

TEST(SceneJson, HoldsTheGroundAroundWhatIsSeen) {
  Scene scene;
  scene.floor = Floor{.roughness = 0.1, .wavelength = 0.9, .seed = 7};
  FilmedLife walker = life_at({{-3, 1, 0}, {-1, 1, 1}});
  walker.film.front().frames.push_back({1, {{3, 2, 0}, {5, 2, 1}}});
  const auto json = scene_json(scene, region_of({walker}));
  const auto& ground = json["ground"];
  const double x = ground["x"], y = ground["y"], spacing = ground["spacing"];
  const std::size_t columns = ground["columns"], rows = ground["rows"];
  EXPECT_NEAR(x, -3 - 3 * 2, 1e-6);
  EXPECT_NEAR(y, 1 - 3 * 2, 1e-6);
  EXPECT_GE(x + spacing * static_cast<double>(columns - 1), 5 + 3 * 2);
  EXPECT_GE(y + spacing * static_cast<double>(rows - 1), 2 + 3 * 2);
  const std::vector<std::int64_t> differences = unpacked(ground["heights"]);
  ASSERT_EQ(differences.size(), columns * rows);
  std::int64_t level = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    level += differences[i];
    const Vec3 at{x + spacing * static_cast<double>(i % columns), y + spacing * static_cast<double>(i / columns), 0};
    ASSERT_NEAR(0.1 * (static_cast<double>(level) / 127 - 1), ground_height(scene, at), 0.51 * 0.1 / 127) << i;
  }
}

TEST(SceneJson, GroundStaysSmallWhereverBodiesGo) {
  Scene scene;
  scene.floor = Floor{.roughness = 0.1, .wavelength = 0.001};
  const FilmedLife born = life_at({{0, 0, 0}, {1, 0, 0}});
  FilmedLife lost = life_at({{0, 0, 0}, {1, 0, 0}}, Status::diverged);
  lost.film.front().frames.push_back({1, {{1e30F, 0, 0}, {0, 1e30F, 0}}});
  const auto ground = scene_json(scene, region_of({lost}))["ground"];
  EXPECT_EQ(ground, scene_json(scene, region_of({born}))["ground"]);
  EXPECT_EQ(ground["columns"], 256);
  EXPECT_LE(ground["rows"], 256);
}

TEST(SceneJson, SaysWhatIsThere) {
  EXPECT_EQ(scene_json({}, {}).dump(), R"({"floor":false,"water":false,"slope":0.0,"ground":null})");
  Scene scene;
  scene.gravity = Gravity{.slope = 12};
  scene.floor = Floor{};
  scene.drag = Drag{};
  EXPECT_EQ(scene_json(scene, {}).dump(), R"({"floor":true,"water":true,"slope":12.0,"ground":null})");
}

TEST(Page, SaysWhereItIsTooLarge) {
  EXPECT_EQ(size_note("r.html", 30'000'000, "--best"), "");
  EXPECT_NE(size_note("r.html", 30'000'001, "--best"), "");
  EXPECT_THAT(size_note("r.html", 41'000'000, "--best"),
              ::testing::AllOf(::testing::HasSubstr("r.html: has 41 MB"), ::testing::HasSubstr("--best\n")));
}

TEST(Page, HoldsDataThatNothingReadsAsMarkup) {
  const std::string page = filled_page("<script>EVODEVO_DATA</script>", {{"name", "</script><script>harm()"}});
  const std::string data = page.substr(8, page.rfind("</script>") - 8);
  EXPECT_EQ(data.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(data)["name"], "</script><script>harm()");
}

TEST(Gallery, KnowsTheMaterialsOfPointsBeforeTheyAreABody) {
  const Experiment experiment = testing::read(
      testing::small_experiment, {{"encoding", "{name = 'neural', points = 21, neighbours = 4}", "--set"}});
  const auto page = gallery_data(experiment, 3);
  const auto& run = page["runs"][0];
  ASSERT_EQ(run["robots"].size(), 3u);
  for (const auto& robot : run["robots"]) {
    ASSERT_EQ(robot["status"], "ok") << robot["reason"];
    const auto& shots = robot["film"]["shots"];
    ASSERT_EQ(shots.size(), 2u);
    EXPECT_EQ(shots[0]["times"].front(), 0.0);
    EXPECT_EQ(shots[0]["times"].back(), shots[1]["times"].front()) << "until they are where they become one";
    const auto of_masses = unpacked(robot["film"]["mass_materials"]);
    ASSERT_EQ(of_masses.size(), 21u);
    for (const std::int64_t material : of_masses)
      EXPECT_TRUE(material >= 0 && material < static_cast<std::int64_t>(run["material_names"].size())) << material;
  }
}

TEST(Report, FilmsFollowWhatARunHasRecorded) {
  const testing::Scratch scratch;
  const Experiment experiment = testing::read(testing::small_experiment);
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  Archive archive = Archive::create(scratch / "run", experiment, simulator->device());
  const std::atomic<bool> stop = false;
  evolve(experiment, *simulator, archive, stop, Observer{});
  const auto films = [&] {
    std::vector<std::string> texts;
    const auto run = reported_run(archive, recorded_experiment(archive), *simulator, {}, page_budget);
    for (const auto& robot : run["robots"])
      if (archive.life(robot["individual"].get<std::uint32_t>())) texts.push_back(robot["film"].dump());
    return texts;
  };
  const std::vector<std::string> before = films();
  ASSERT_GE(before.size(), 2u);
  std::string other = archive.record("experiment");
  archive.set_record("experiment", other.replace(other.find("seed = 7"), 8, "seed = 8"));
  EXPECT_EQ(films(), before) << "though development draws other numbers now";
}

/// The filmed speed of the best robot is that which its distances along x and y make.
TEST(Report, SaysHowNearTheBestCameToTheTopSpeed) {
  const auto reported = [](const std::string& text) {
    const testing::Scratch scratch;
    const Experiment experiment = testing::read(text);
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
    Archive archive = Archive::create(scratch / "run", experiment, simulator->device());
    const std::atomic<bool> stop = false;
    evolve(experiment, *simulator, archive, stop, Observer{});
    return reported_run(archive, experiment, *simulator, {}, page_budget);
  };
  std::string text = testing::small_experiment;
  text.replace(text.find("\"actuation-work\""), 16, "\"distance\"\nlabel = \"sideways\"\ndirection = [0, 1, 0]");
  const auto run = reported(text);
  const auto& found = run["top_speed"];
  const auto& best = run["robots"][0]["objectives"];
  const double lengths = std::hypot(best["distance"].get<double>(), best["sideways"].get<double>());
  EXPECT_GT(lengths, 1e-4);
  EXPECT_NEAR(found["speed"].get<double>(), lengths * found["length"].get<double>() / 0.1, 1e-5);
  EXPECT_DOUBLE_EQ(found["limit"].get<double>(), 0.5 * 9.81 / Damping().rate);
  const auto without = [&](const std::string& table) {
    std::string changed = text;
    changed.erase(changed.find(table), table.size());
    return reported(changed)["top_speed"];
  };
  EXPECT_TRUE(without("[scene.damping]")["limit"].is_null());
  EXPECT_GT(without("[scene.damping]")["speed"], 0);
  EXPECT_TRUE(without("[scene.friction]").is_null());
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
