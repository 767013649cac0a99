// The data in pages of the viewer, whose numbers can be unpacked; the numbers of a run with several objectives: the
// progress in each, the best of each, and the scores of the living; and the permutation test of scenes.
#include "report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "analysis/ground.hpp"
#include "archive/recorded_experiment.hpp"
#include "environments/scene_effect.hpp"
#include "report/diversity.hpp"
#include "report/film_json.hpp"
#include "report/filming.hpp"
#include "report/packing.hpp"
#include "report/page.hpp"
#include "report/run_json.hpp"
#include "report/scene_json.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre, ::testing::Pair;
using Json = nlohmann::ordered_json;
using Numbers = std::vector<std::int64_t>;
using Indices = std::vector<std::uint32_t>;

/// Unpacks a text in the same way as a page.
Numbers unpacked(const std::string& text) {
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
  Numbers numbers;
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
  Numbers numbers;
  EXPECT_EQ(unpacked(packed(numbers)), numbers);
  for (const std::int64_t next : {0LL, -1LL, 1LL, 63LL, -64LL, 64LL, 8191LL, -8193LL, 1'000'000'007LL, -(1LL << 40)}) {
    numbers.push_back(next);
    EXPECT_EQ(unpacked(packed(numbers)), numbers);
  }
}

TEST(Packing, TellsWhatCameAndWentAndHowValuesDifferFromTheirLast) {
  EXPECT_THAT(unpacked(packed_changes(Indices{1, 2, 5}, Indices{2, 3, 5, 9})), ElementsAre(1, 2, 6));
  ValuePacking values(4);
  EXPECT_THAT(unpacked(values.next(Indices{0, 3}, Numbers{7, 9})), ElementsAre(7, 9));
  EXPECT_THAT(unpacked(values.next(Indices{1, 3}, Numbers{5, 8})), ElementsAre(5, -1));
  EXPECT_THAT(unpacked(values.next(Indices{0}, Numbers{7})), ElementsAre(0));
}

TEST(Packing, TellsPlacesByHowMassesMoved) {
  const Frame a{0, {{1, 2, 3}, {2, 2, 3}}}, b{1, {{2, 2, 3}, {3, 2, 3}}}, c{2, {{4, 2, 3}, {5, 2, 7}}};
  const Frame after{2, {{5, 2, 7}, {6, 2, 7}}};
  const std::vector<const Frame*> frames = {&a, &b, &c}, again = {&after};
  PlacePacking positions(3, 0.5);
  EXPECT_THAT(unpacked(positions.next(frames, Indices{0, 1})),
              ElementsAre(2, 2, 4, 0, 6, 0, 2, 2, 0, 0, 0, 0, 3, 3, 0, 0, 0, 8));
  // the second mass stays at its position, and a new one is added
  EXPECT_THAT(unpacked(positions.next(again, Indices{1, 2})), ElementsAre(0, 2, 0, 0, 0, 0));
}

TEST(Packing, PlacesOutOfReachAreAtItsEnd) {
  EXPECT_EQ(whole_steps(-3.3, 0.5), -7);
  for (const double far : {1e6, 1e34, 1e300}) {
    EXPECT_EQ(whole_steps(far, 1e-4), 1 << 29);
    EXPECT_EQ(whole_steps(-far, 1e-4), -(1 << 29));
  }
}

/// Returns `count` numbers from 0.
template <class T>
std::vector<T> counted(std::size_t count) {
  std::vector<T> numbers(count);
  std::iota(numbers.begin(), numbers.end(), T{});
  return numbers;
}

/// A shot of a body with masses at the given x positions, with the given numbers, joined in the given pairs.
Shot shot_of(const std::vector<double>& positions, Indices numbers,
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
  const auto positions = counted<double>(masses);
  Shot shot = shot_of(positions, counted<std::uint32_t>(masses), {{0, 1}});
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
  for (int i = 1; i <= 4; ++i) shot.frames.push_back({static_cast<double>(i), shot.frames[0].positions});
  shot.frames[1].positions[0] = {0, 1, 0};
  const auto json = film_json({shot}, {{"jump"}}, 1'000'000);
  EXPECT_EQ(json["shots"][0]["times"], (std::vector<double>{0, 2, 4}));
  EXPECT_NEAR(json["error"]["largest"].get<double>(), 1, 1e-3);
}

/// A life as long as those of the paper, with a fifth of the masses and springs. All masses pulse once per second, each
/// with an amplitude of its own and some noise, and drift away; stress differs from shot to shot.
Film long_life(int cycles) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  Shot shot;
  shot.numbers = counted<std::uint32_t>(200);
  shot.body.materials.resize(4);
  for (int i = 0; i < 200; ++i)
    shot.body.masses.push_back({.rest = {any(random), any(random), any(random)}, .mass = 0.2, .material = 0});
  constexpr std::size_t springs = 2500;
  std::vector<Spring> all;  // that could be; the first ones are
  for (std::uint32_t a = 0; a < 200; ++a)
    for (std::uint32_t b = 0; b < a; ++b) all.push_back({a, b, 1, (a + b) % 4});
  std::shuffle(all.begin(), all.end(), random);
  shot.stress.resize(springs);
  Film film;
  double time = 0;
  for (int i = 0; i < cycles + 2; ++i) {
    for (int turnover = 0; i < cycles && turnover < 25; ++turnover)
      std::swap(all[random() % springs], all[springs + random() % (all.size() - springs)]);
    shot.body.springs.assign(all.begin(), all.begin() + springs);
    for (double& stress : shot.stress) stress = std::exp(2 * any(random));
    shot.frames = film.empty() ? std::vector<Frame>{} : std::vector<Frame>{film.back().frames.back()};
    const double duration = i < cycles ? 1 : i == cycles ? 3 : 10;
    for (double t = film.empty() ? 0 : 1 / filmed_frames_per_second; t < duration + 1e-9;
         t += 1 / filmed_frames_per_second) {
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
  std::vector<Title> titles(cycles, {"cycle"});
  titles.insert(titles.end(), {{"settling"}, {"measured", true}});
  const auto json = film_json(long_life(cycles), titles, budget);
  EXPECT_LE(json.dump().size(), budget + 200);  // the error is added after packing
  for (std::size_t i = 0; i < cycles; ++i)
    EXPECT_GT(json["shots"][i]["times"].size(), 2u) << "between its ends something is seen";
  const double measured = json["shots"].back()["times"].size() / 10.0;  // frames per second
  EXPECT_GE(measured, 3 * static_cast<double>(json["shots"][0]["times"].size() - 1));
  EXPECT_LT(json["stress_levels"], 255) << "or else this life is not long";
}

TEST(FilmJson, StatesTheErrorOfStress) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t i = 0; i + 1 < 300; ++i) pairs.emplace_back(i, i + 1);
  Shot shot = shot_of(counted<double>(300), counted<std::uint32_t>(300), pairs);
  shot.stress = counted<double>(299);
  for (const std::size_t budget : {1'000'000u, 0u}) {
    const auto json = film_json({shot}, {{"one"}}, budget);
    const double most = json["most_stress"], levels = json["stress_levels"], error = json["error"]["stress"];
    const Numbers shown = unpacked(json["shots"][0]["stress"]);
    double largest = 0;
    for (std::size_t s = 0; s < shown.size(); ++s) {
      const double part = static_cast<double>(shown[s]) / levels;
      largest = std::max(largest, std::abs(most * part * part - shot.stress[s]));
    }
    EXPECT_LE(largest, error);
    EXPECT_GT(largest, 0.5 * error);
  }
}

/// The region of a filmed life, in the frames of which the masses are at these positions.
SeenRegion seen_in(const std::vector<std::vector<SeenPlace>>& frames, Status status = Status::ok) {
  FilmedLife life;
  life.result.status = status;
  Shot& shot = life.film.emplace_back();
  for (const auto& positions : frames) shot.frames.push_back({static_cast<double>(shot.frames.size()), positions});
  SeenRegion region;
  region.include({life});
  return region;
}

TEST(SceneJson, HoldsTheGroundAroundWhatIsSeen) {
  Scene scene;
  scene.floor = Floor{.roughness = 0.1, .wavelength = 0.9, .seed = 7};
  const auto json = scene_json(scene, seen_in({{{-3, 1, 0}, {-1, 1, 1}}, {{3, 2, 0}, {5, 2, 1}}}));
  const auto& ground = json["ground"];
  const double x = ground["x"], y = ground["y"], spacing = ground["spacing"];
  const std::size_t columns = ground["columns"], rows = ground["rows"];
  EXPECT_NEAR(x, -3 - 3 * 2, 1e-6);
  EXPECT_NEAR(y, 1 - 3 * 2, 1e-6);
  EXPECT_GE(x + spacing * static_cast<double>(columns - 1), 5 + 3 * 2);
  EXPECT_GE(y + spacing * static_cast<double>(rows - 1), 2 + 3 * 2);
  const Numbers differences = unpacked(ground["heights"]);
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
  const std::vector<SeenPlace> born{{0, 0, 0}, {1, 0, 0}}, lost{{1e30F, 0, 0}, {0, 1e30F, 0}};
  const auto ground = scene_json(scene, seen_in({born, lost}, Status::diverged))["ground"];
  EXPECT_EQ(ground, scene_json(scene, seen_in({born}))["ground"]);
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
  EXPECT_THAT(size_note("r.html", 41'000'000, "--best"), testing::naming("r.html: has 41 MB", "--best\n"));
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
  const auto run = gallery_data(experiment, 3)["runs"][0];
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
  testing::FinishedRun finished(testing::small());
  Archive& archive = finished.archive;
  const auto films = [&] {
    std::vector<std::string> texts;
    const auto run = reported_run(archive, recorded_experiment(archive), *finished.simulator, {}, page_budget);
    for (const auto& robot : run["robots"])
      if (!archive.lives(robot["individual"].get<std::uint32_t>()).empty()) texts.push_back(robot["film"].dump());
    return texts;
  };
  const std::vector<std::string> before = films();
  ASSERT_GE(before.size(), 2u);
  std::string other = archive.record("experiment");
  archive.set_record("experiment", other.replace(other.find("seed = 7"), 8, "seed = 8"));
  EXPECT_EQ(films(), before) << "though development draws other numbers now";
}

TEST(Report, ShowsEachLifeOfTheBestAndOfElitesTheFirst) {
  const testing::FinishedRun run(
      testing::small({"experiment.lives=3", "experiment.birth_noise=0.02", "development.draws_between_lives=new",
                      "fitness.1={name='descriptor', settle=0.05, window=0.1}"}));
  const auto shown = [&](const Cast& cast) {
    return reported_run(run.archive, run.experiment, *run.simulator, cast, page_budget)["robots"];
  };
  std::map<std::uint32_t, std::vector<int>> lives;
  for (const auto& robot : shown({.best = 2, .ancestors = 0})) {
    const int life = robot["life"].get<int>();
    lives[robot["individual"].get<std::uint32_t>()].push_back(life);
    ASSERT_EQ(robot["lives"].size(), 3u);
    EXPECT_EQ(robot["again"][0], robot["lives"][life - 1]["distance"]) << "the film shows this life";
  }
  for (const std::uint32_t id : run.archive.best(2)) EXPECT_THAT(lives[id], ::testing::ElementsAre(1, 2, 3));
  const auto second = shown({.best = 1, .ancestors = 0, .life = 2});
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(second[0]["life"], 2);
  for (const auto& elite : shown({.best = 0, .best_of_others = 0, .ancestors = 0, .elites = 9}))
    EXPECT_EQ(elite["life"], 1);
}

/// The filmed speed of the best robot is that which its distances along x and y make.
TEST(Report, SaysHowNearTheBestCameToTheTopSpeed) {
  const auto reported = [](const std::function<void(Scene&)>& change) {
    Experiment experiment =
        testing::small({"fitness.1={name='distance', label='sideways', direction=[0, 1, 0], settle=0.05, window=0.1}"});
    change(experiment.scene);
    const testing::FinishedRun run(std::move(experiment));
    return reported_run(run.archive, run.experiment, *run.simulator, {}, page_budget);
  };
  const auto run = reported([](Scene&) {});
  const auto& found = run["top_speed"];
  const auto& best = run["robots"][0]["objectives"];
  const double lengths = std::hypot(best["distance"].get<double>(), best["sideways"].get<double>());
  EXPECT_GT(lengths, 1e-4);
  EXPECT_NEAR(found["speed"].get<double>(), lengths * found["length"].get<double>() / 0.1, 1e-5);
  EXPECT_DOUBLE_EQ(found["limit"].get<double>(), 0.5 * 9.81 / Damping().rate);
  const auto undamped = reported([](Scene& scene) { scene.damping.reset(); });
  EXPECT_TRUE(undamped["top_speed"]["limit"].is_null());
  EXPECT_GT(undamped["top_speed"]["speed"], 0);
  EXPECT_TRUE(reported([](Scene& scene) { scene.friction.reset(); })["top_speed"].is_null());
}

/// A finished run with the objectives distance and actuation-work, of which the second is minimised, a descriptor, and
/// two scenarios.
class RunJson : public ::testing::Test {
 protected:
  static inline const std::string scenarios =
      "[[scenario]]\nname = 'flat'\n[[scenario]]\nname = 'hurt'\ndamage = 0.1\nrepeat = 2\n";
  static inline const std::string stature =
      "{name='descriptor', what='height', label='stature', range=[0.0, 1.0], bins=1000, settle=0.05, window=0.1}";

  void SetUp() override {
    while (!is_finished(experiment_, archive_.generations())) {
      testing::evolve_to(archive_.generations().size() + 1, experiment_, archive_);
      population_.push_back(archive_.population());
    }
  }

  /// The scores in an objective of the individuals alive after a generation.
  std::vector<double> living(std::size_t generation, std::size_t objective) const {
    std::vector<double> scores;
    for (const Individual& individual : population_.at(generation))
      if (individual.result.status == Status::ok) scores.push_back(individual.result.objectives.at(objective));
    std::sort(scores.begin(), scores.end());
    return scores;
  }

  testing::Scratch scratch_;
  Experiment experiment_ = testing::read(testing::small_experiment + scenarios, {{"fitness.2", stature, ""}});
  std::unique_ptr<Simulator> simulator_ = make_cpu_simulator(experiment_.scene, experiment_.stepping, 1);
  Archive archive_ = Archive::create(scratch_ / "run", experiment_, simulator_->device());
  std::vector<std::vector<Individual>> population_;  ///< after each generation
};

/// The individuals that a report shows, and their roles.
std::vector<std::pair<std::uint32_t, std::string>> robots_of(const Json& run) {
  std::vector<std::pair<std::uint32_t, std::string>> robots;
  for (const Json& robot : run["robots"]) robots.emplace_back(robot["individual"], robot["role"]);
  return robots;
}

double median(const std::vector<double>& sorted) {
  return (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]) / 2;
}

TEST_F(RunJson, HasTheProgressOfTheLivingAndTheBestInEachObjectiveAndNamesTheOtherScores) {
  const Json run = run_json(archive_, experiment_), &generations = run["generations"], &objectives = run["objectives"];
  ASSERT_EQ(generations.size(), population_.size());
  ASSERT_GT(generations.size(), 2u);
  for (std::size_t g = 0; g < generations.size(); ++g) {
    const auto &distance = generations[g]["objectives"]["distance"],
               &work = generations[g]["objectives"]["actuation-work"];
    EXPECT_EQ(distance["best"], generations[g]["best"]);
    EXPECT_EQ(distance["best"], living(g, 0).back());
    EXPECT_EQ(distance["median"], median(living(g, 0)));
    EXPECT_EQ(work["best"], living(g, 1).front()) << "the least";
    EXPECT_EQ(work["median"], median(living(g, 1)));
  }
  std::map<std::uint32_t, std::uint32_t> ids;  // of the best so far of the generations in which it changed
  double most = -std::numeric_limits<double>::infinity(), least = -most;
  for (std::uint32_t id = 0; id < 24; ++id) {
    const auto one = archive_.known_individual(id);
    if (one.result.status != Status::ok) continue;
    least = std::min(least, one.result.objectives[1]);
    if (one.result.objectives[0] <= most) continue;
    most = one.result.objectives[0];
    ids[one.born] = id;
  }
  EXPECT_EQ(objectives[0]["best"]["value"], most);
  EXPECT_EQ(objectives[1]["best"]["value"], least);
  const auto best = objectives[1]["best"]["individual"].get<std::uint32_t>();
  EXPECT_EQ(archive_.known_individual(best).result.objectives[1], objectives[1]["best"]["value"]);
  EXPECT_EQ(run["measures"].dump(), R"([{"name":"stature","unit":"m","role":"descriptor"}])");
  ASSERT_GT(ids.size(), 1u);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
  for (const BestSoFar& one : best_over_generations(archive_)) {
    found.emplace_back(one.born, one.individual);
    EXPECT_EQ(one.value, archive_.known_individual(one.individual).result.objectives[0]);
  }
  EXPECT_EQ(found, (std::vector<std::pair<std::uint32_t, std::uint32_t>>(ids.begin(), ids.end())));
}

TEST_F(RunJson, AReportShowsTheBestElites) {
  const auto ids = best_elites(niche_map(archive_), 2);
  ASSERT_EQ(ids.size(), 2u);
  const Json run = reported_run(archive_, experiment_, *simulator_,
                                {.best = 1, .best_of_others = 0, .ancestors = 0, .elites = 2}, 1'000'000);
  EXPECT_THAT(robots_of(run), ElementsAre(Pair(ids[0], "best in distance"), Pair(ids[1], "elite")))
      << "the best is an elite, too";
  EXPECT_FALSE(run["robots"][1]["film"]["shots"].empty());
}

TEST_F(RunJson, AReportShowsTheLineOfTheBestFromItsFounder) {
  const double best = archive_.known_individual(archive_.best(1).at(0)).result.objectives[0];
  std::uint32_t founder = 0;
  while (archive_.known_individual(founder).result.status != Status::ok) ++founder;
  Individual child = archive_.known_individual(founder);
  ASSERT_EQ(child.born, 0u);
  child.result.objectives[0] = best;
  std::vector<std::uint32_t> line;
  for (std::uint32_t generation = archive_.generations().back().generation + 1; line.size() < 4; ++generation) {
    child.parents = {child.id};
    child.id = 24 + static_cast<std::uint32_t>(line.size());
    child.born = child.measured = generation;
    child.result.objectives[0] += 1;  // better than all before
    archive_.commit({.newborns = {child}, .summary = {.generation = generation, .evaluations = child.id + 1}});
    line.push_back(child.id);
  }
  const auto shown = [&](std::size_t ancestors) {
    return robots_of(reported_run(archive_, experiment_, *simulator_,
                                  {.best = 1, .best_of_others = 0, .ancestors = ancestors, .elites = 0}, 1'000'000));
  };
  EXPECT_THAT(shown(4), ElementsAre(Pair(line[3], "best in distance"), Pair(founder, "founder"),
                                    Pair(line[0], "ancestor"), Pair(line[1], "ancestor"), Pair(line[2], "ancestor")));
  EXPECT_THAT(shown(2),
              ElementsAre(Pair(line[3], "best in distance"), Pair(founder, "founder"), Pair(line[1], "ancestor")));
}

TEST_F(RunJson, AReportHasTheScoresOfTheLivingAndTheBestInEachObjective) {
  const Json run = reported_run(archive_, experiment_, *simulator_, {.best = 1, .ancestors = 0}, 1'000'000, 1);
  EXPECT_EQ(run["filmed_scenario"], "hurt");
  ASSERT_EQ(run["population"].size(), living(population_.size() - 1, 0).size());
  for (const Json& one : run["population"]) {
    const auto id = one["id"].get<std::uint32_t>();
    EXPECT_EQ(one["objectives"]["actuation-work"], archive_.known_individual(id).result.objectives[1]);
    EXPECT_EQ(one["measures"]["stature"], archive_.measures(id)[0].value);
  }
  EXPECT_THAT(robots_of(run), ElementsAre(Pair(archive_.best(1).at(0), "best in distance"),
                                          Pair(run["objectives"][1]["best"]["individual"], "best in actuation-work")));
}

using Distances = std::vector<std::vector<double>>;

/// Returns the distances between bodies that are represented by one number each.
Distances distances(const std::vector<double>& bodies) {
  Distances all(bodies.size(), std::vector<double>(bodies.size()));
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) all[i][j] = std::abs(bodies[i] - bodies[j]);
  return all;
}

TEST(SceneEffect, HoldsTheMeansAndOfOneBodyADistanceAndNoMore) {
  const SceneEffect effect = scene_effect(distances({0, 0.1, 0.2, 1, 1}), 3);
  EXPECT_NEAR(effect.between, 0.9, 1e-12);
  // the mean distance is 0.4/3 within the first scene and 0 within the other
  EXPECT_NEAR(effect.within.value(), 0.2 / 3, 1e-12);
  const SceneEffect of_one = scene_effect(distances({0, 0.4, 0.6}), 1);
  EXPECT_NEAR(of_one.between, 0.5, 1e-12);
  EXPECT_FALSE(of_one.within);
  EXPECT_FALSE(of_one.p);
}

TEST(SceneEffect, IsAsRareAsItsDeal) {
  // of the 20 ways to assign six bodies to two scenes, 2 give at least this effect; for ten bodies, it is 2 of the 252
  // ways
  EXPECT_NEAR(scene_effect(distances({0, 0.01, 0.02, 0.9, 0.91, 0.92}), 3).p.value(), 0.1, 0.015);
  EXPECT_NEAR(scene_effect(distances({0, 0.1, 0.2, 0.3, 0.4, 1, 1.1, 1.2, 1.3, 1.4}), 5).p.value(), 2.0 / 252, 0.004);
  EXPECT_NEAR(scene_effect(distances({0, 0.3, 0.5, 0.1, 0.8, 0.9}), 3).p.value(), 8.0 / 20, 0.02);
  EXPECT_NEAR(scene_effect(distances({0, 0.6, 0.2, 0.5, 0.9, 0.4, 1}), 3).p.value(), 6.0 / 35, 0.016);
  EXPECT_EQ(scene_effect(distances({0, 0.5, 1, 0, 0.5, 1}), 3).p, 1) << "no deal is less far apart";
  EXPECT_EQ(scene_effect(distances({1, 1, 1, 1}), 2).p, 1) << "all are equal";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
