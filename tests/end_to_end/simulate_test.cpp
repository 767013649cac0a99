// The command `evodevo simulate`: bodies taken from a run move as they did in that run, and unsuitable bodies and
// options are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "analysis/ground.hpp"
#include "archive/archive.hpp"
#include "archive/recorded_experiment.hpp"
#include "life/evaluation.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using ::testing::AllOf;
using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

/// Returns an experiment with rough ground, a payload and time steps that are not powers of two.
std::string awkward_experiment() {
  std::string text = small_experiment;
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  };
  replace("[scene.floor]",
          "[scene.payload]\nshare = 0.37\n[scene.floor]\nstiffness = 1e4\nroughness = 0.11\nwavelength = 0.7");
  replace("[simulation]", "[simulation]\ndevice = \"cpu\"\ndt = 0.0007");
  replace("cycle_time = 0.05", "cycle_time = 0.049");
  replace("settle = 0.05", "settle = 0.049");
  replace("window = 0.1", "window = 0.098");
  return text;
}

/// The state of all masses at one moment of a trajectory.
struct Seen {
  double time = 0;
  std::vector<Vec3> position, velocity;
};

std::vector<Seen> trajectory_in(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  EXPECT_EQ(line, "time,mass,x,y,z,vx,vy,vz");
  std::vector<Seen> frames;
  while (std::getline(stream, line)) {
    std::vector<double> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(std::strtod(cell.c_str(), nullptr));
    EXPECT_EQ(cells.size(), 8u) << line;
    cells.resize(8);
    if (cells[1] == 0) frames.push_back({.time = cells[0]});
    frames.back().position.push_back({cells[2], cells[3], cells[4]});
    frames.back().velocity.push_back({cells[5], cells[6], cells[7]});
  }
  return frames;
}

void expect_same_bits(const Seen& seen, const State& state) {
  EXPECT_EQ(seen.time, state.time);
  EXPECT_EQ(seen.position, state.position);
  EXPECT_EQ(seen.velocity, state.velocity);
}

class Simulate : public ::testing::Test {
 protected:
  Scratch scratch_;
  std::string file_ = scratch_.write("two bodies (rough).toml", awkward_experiment());
  std::string folder_ = (scratch_ / "run").string();
  std::string csv_ = (scratch_ / "t.csv").string();

  /// Simulates a body for 14 steps, which is less than the time between two frames; returns the first and the last
  /// state.
  std::pair<Seen, Seen> simulated(const std::string& json) {
    const std::string told = simulate(json, {"--trajectory", csv_}, 0, "0.0098");
    EXPECT_THAT(told, HasSubstr("\nafter 0.0098 s the centre")) << "however old it was before";
    const std::vector<Seen> frames = trajectory_in(csv_);
    EXPECT_EQ(frames.size(), 2u);
    return {frames.front(), frames.back()};
  }

  /// Repeats the life of the run's best individual as it was in the run.
  struct Again {
    ArchivedIndividual individual;
    Experiment experiment;
    std::unique_ptr<Simulator> simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
    Evaluation evaluation{experiment, *simulator};
    Newborn newborn{individual.id, individual.born, &individual.genome};
    std::vector<Life> lives = evaluation.birth.of({&newborn, 1});

    Life& go_on() {
      evaluation.simulation.run(lives, {.duration = 0.0098},
                                [&](std::span<Task> tasks, auto) { simulator->run(tasks, {}); });
      return lives.front();
    }
  };
  std::unique_ptr<Again> again() const {
    const Archive archive = Archive::read(folder_);
    return std::unique_ptr<Again>(new Again{*archive.individual(archive.best(1).at(0)), recorded_experiment(archive)});
  }

  /// Simulates a body, expects the exit code, and returns the output.
  std::string simulate(const std::string& json, const Words& more = {}, int exit_code = 0,
                       const std::string& duration = "0.1") {
    const Words words{"simulate", scratch_.write("own.json", json), file_, "--duration", duration};
    return output_of(program(joined(words, more)), exit_code);
  }
  std::string refusal(const std::string& json) { return simulate(json, {}, 2); }
};

TEST_F(Simulate, ABodyLivesAsInItsRunUnderItsLoadAndOnItsGroundNewbornOrMatured) {
  said({"run", file_, "--out", folder_, "--set", "experiment.verify=0"});
  const auto newborn = again();
  const State born = newborn->lives.front().living.state;
  const auto [first, last] = simulated(said({"body", folder_}));
  expect_same_bits(first, born);
  expect_same_bits(last, newborn->go_on().living.state);

  const auto life = again();
  life->evaluation.development.run(life->lives, [](double) {});
  const LivingBody& matured = life->lives.front().living;
  const std::string body = said({"body", folder_, "--matured"});
  const Json json = Json::parse(body);
  EXPECT_EQ(json.at("time").get<double>(), matured.state.time);
  EXPECT_EQ(json.at("start_energy").get<double>(), matured.state.start_energy);
  double own = 0, written = 0;
  for (const Mass& mass : matured.body.masses) own += mass.mass;
  for (const Json& mass : json.at("masses")) written += mass.at("mass").get<double>();
  EXPECT_EQ(written, own) << "its load is on it and comes on it only once";
  const State before = matured.state;
  const auto [matured_first, matured_last] = simulated(body);
  expect_same_bits(matured_first, before);
  EXPECT_THAT(before.velocity, ::testing::Contains(::testing::Ne(Vec3{})));
  expect_same_bits(matured_last, life->go_on().living.state);
}

/// Returns the distance along x between the centres of mass of two moments, in body lengths at the first one.
double body_lengths(const Json& body, const Seen& from, const Seen& to) {
  double total = 0;
  Vec3 moved, lowest = from.position[0], highest = lowest;
  for (std::size_t i = 0; i < from.position.size(); ++i) {
    const double mass = body.at("masses").at(i).at("mass");
    total += mass;
    moved = moved + (to.position[i] - from.position[i]) * mass;
    const Vec3& p = from.position[i];
    lowest = {std::min(lowest.x, p.x), std::min(lowest.y, p.y), std::min(lowest.z, p.z)};
    highest = {std::max(highest.x, p.x), std::max(highest.y, p.y), std::max(highest.z, p.z)};
  }
  const Vec3 box = highest - lowest;
  return moved.x / total / std::max({box.x, box.y, box.z});
}

TEST_F(Simulate, WithAStepOfItsOwnABodyMovesAsItDidHoweverLongOneLooks) {
  const Words settings{"--set", "simulation.dt=auto", "--set", "development.cycle_time=0.07"};
  said(joined({"run", file_, "--out", folder_, "--set", "experiment.verify=0", "--set", "fitness.0.settle=0", "--set",
               "fitness.0.window=0.373"},
              settings));
  const Archive archive = Archive::read(folder_);
  const double score = archive.individual(archive.best(1).at(0))->result.objectives.at(0);
  ASSERT_GT(score, 0);
  const std::string body = said({"body", folder_, "--matured"});
  const Words options = joined({"--trajectory", csv_}, settings);
  simulate(body, options, 0, "0.373");
  const std::vector<Seen> short_look = trajectory_in(csv_);
  EXPECT_NEAR(body_lengths(Json::parse(body), short_look.front(), short_look.back()), score, 1e-9 * score);
  for (const std::string duration : {"0.4", "0.5131"}) {
    simulate(body, options, 0, duration);
    const std::vector<Seen> longer = trajectory_in(csv_);
    ASSERT_GT(longer.size(), short_look.size()) << duration;
    for (std::size_t i = 0; i + 1 < short_look.size(); ++i) {
      EXPECT_EQ(longer[i].time, short_look[i].time);
      EXPECT_EQ(longer[i].position, short_look[i].position) << "frame " << i << " of " << duration << " s";
    }
  }
}

TEST_F(Simulate, ABodyThatGrewInAnotherSceneGoesOnToo) {
  const Json grown = Json::parse(said({"environments", file_, "--starts", "1", "--json"}));
  const Json body = grown.at(0).at("scenes").at(0).at("starts").at(0).at("body");
  const auto [first, last] = simulated(body.dump());
  EXPECT_EQ(first.time, 2 * 0.049);
  EXPECT_EQ(first.position[3].x, body.at("masses").at(3).at("position").at(0).get<double>());
  EXPECT_EQ(first.velocity[3].z, body.at("masses").at(3).at("velocity").at(2).get<double>());
}

/// Returns the JSON of a body: four masses in a soft tetrahedron of 1 m. `more` is added to each mass, `rest` to the
/// body.
std::string tetrahedron(const std::string& mass, double stiffness, const std::string& more = "",
                        const std::string& rest = "", double z = 0) {
  std::string masses, springs;
  const double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0.5, 0.8, 0}, {0.5, 0.3, 0.8}};
  for (int i = 0; i < 4; ++i) {
    masses += std::string(i > 0 ? "," : "") + R"({"position": [)" + std::to_string(positions[i][0]) + "," +
              std::to_string(positions[i][1]) + "," + std::to_string(positions[i][2] + z) + R"(], "mass": )" + mass +
              more + "}";
    for (int j = 0; j < i; ++j)
      springs += std::string(springs.empty() ? "" : ",") + R"({"a": )" + std::to_string(i) + R"(, "b": )" +
                 std::to_string(j) + R"(, "rest_length": 0.95, "material": 0})";
  }
  return R"({"masses": [)" + masses + R"(], "springs": [)" + springs + R"(], "materials": [{"stiffness": )" +
         std::to_string(stiffness) + R"(, "amplitude": 0, "frequency": 0, "phase": 0}])" + rest + "}";
}

TEST_F(Simulate, ABodyIsBornOnTheGroundHoweverHighItLies) {
  for (const double z : {-0.4, 0.0, 7.3}) {
    simulate(tetrahedron("0.2", 500, "", "", z), {"--trajectory", csv_, "--set", "scene.floor.roughness=0.5"});
    Scene scene;
    scene.floor = Floor{};
    scene.floor->roughness = 0.5, scene.floor->wavelength = 0.7;
    const std::vector<Seen> frames = trajectory_in(csv_);
    double lowest = 1e300, fastest = 0;
    for (const Vec3& position : frames.front().position)
      lowest = std::min(lowest, position.z - ground_height(scene, position));
    for (const Vec3& velocity : frames.back().velocity) fastest = std::max(fastest, norm(velocity));
    EXPECT_NEAR(lowest, 0, 1e-12) << z;
    EXPECT_LT(fastest, 3) << z;
  }
}

TEST_F(Simulate, AStateInsideTheGroundIsInvalid) {
  const auto at = [&](double z) { return tetrahedron("0.2", 500, "", R"(, "time": 1.5)", z); };
  EXPECT_THAT(refusal(at(-0.4)), naming("own.json: invalid: ", "ground", " J", "leave out \"time\""));
  simulate(at(0.5));  // it falls
  // a single mass where the floor, of 1e4 N/m, carries it
  simulate(R"({"masses": [{"position": [0, 0, -1.962e-4], "mass": 0.2}], "springs": [], "materials": [], "time": 1.5})",
           {"--set", "scene.floor.roughness=0"});
}

TEST_F(Simulate, TheStepIsJudgedByTheBodysOwnMassesAndMaterialsUnlessTheFileAsksForWhatIsUnstable) {
  const Words light_encoding{"--set", "encoding.mass=0.002"}, unstable{"--set", "simulation.unstable=run"};
  testing::refusal(joined({"check", file_}, light_encoding));
  simulate(tetrahedron("0.5", 500), light_encoding);                             // no mass of this body is that light
  simulate(tetrahedron("0.5", 500), {"--set", "materials.bone.stiffness=1e9"});  // nothing of this body is bone
  EXPECT_THAT(refusal(tetrahedron("0.5", 2e7)), naming("invalid: unstable dt: 0.0007 s", "springs", "simulation.dt"));
  EXPECT_THAT(refusal(tetrahedron("0.002", 500)), HasSubstr("lightest mass"));

  EXPECT_THAT(simulate(tetrahedron("0.5", 2e7), unstable, 1), HasSubstr("diverged after "));
  const std::string light = scratch_.write("light.json", tetrahedron("0.002", 500));
  EXPECT_THAT(testing::evodevo(joined({"simulate", light, file_, "--duration", "0.1"}, unstable)).output,
              naming("4 masses, 6 springs", "cpu"))
      << "whatever becomes of it";
  simulate(tetrahedron("0.5", 500), joined(unstable, light_encoding));
  said(joined(joined({"check", file_}, unstable), light_encoding));
}

TEST_F(Simulate, OnlyALifeUnderWayHasVelocities) {
  const std::string velocity = R"(, "velocity": [0, 1.5, 0])";
  EXPECT_THAT(refusal(tetrahedron("0.2", 500, velocity)), naming("masses[0].velocity", "\"time\""));
  simulate(tetrahedron("0.2", 500, velocity, R"(, "time": 0)", 3),
           {"--trajectory", csv_, "--set", "scene={gravity={}}", "--set", "simulation.precision=double"});
  Vec3 moved;
  const std::vector<Seen> frames = trajectory_in(csv_);
  for (std::size_t i = 0; i < 4; ++i) moved = moved + 0.25 * (frames.back().position[i] - frames.front().position[i]);
  EXPECT_NEAR(moved.y, 1.5 * 0.1, 1e-3);
  EXPECT_NEAR(moved.z, -9.81 / 2 * 0.01, 1e-3);
}

TEST_F(Simulate, FaultyBodiesAreRefusedByPlaceInOneCleanLine) {
  const auto body = [](const std::string& mass_more, const std::string& rest = "") {
    return tetrahedron("0.2", 500, mass_more, rest);
  };
  const std::string masses = R"("masses": [{"position": [0,0,0], "mass": 1}, {"position": [1,0,0], "mass": 1}])";
  const std::string materials = R"({"materials": [{"stiffness": 1, "amplitude": 0, "frequency": 0, "phase": 0}], )";
  struct Case {
    std::string json, place, remedy;
  };
  for (const auto& [json, place, remedy] : std::vector<Case>{
           {body(R"(, "velocty": [0, 0, 0])"), ": masses[0].velocty", "did you mean \"velocity\"?"},
           {body("", R"(, "colour": "red")"), ": colour: ", "known: "},
           {body(R"(, "mass": 0.3)"), ": masses[0].mass", "twice"},
           {body("", R"(, "masses": [])"), ": masses: ", "twice"},
           {body("", R"(, "\u001b[31mred": 1)"), ": ", "\\u001b[31mred"},
           {body("", ", \"" + std::string(5000, 'k') + "\": 1"), ": ", "kkk..."},
           {body("", ", \"time\": " + std::string(100000, '[')), ": ", "levels"},
           {std::string(100'000, '[') + std::string(100'000, ']'), ": ", "16 levels"},
           {body("", R"(, "time": -1)"), ": time", "-1"},
           {"[1]", ": ", "object"},
           {"{", ": ", "JSON"},
           {"{\x1b\n\xff", ": ", "<U+001B>"},
           {"{}", ": ", "\"materials\""},
           {materials + R"("masses": [{"position": [0,0], "mass": 1}], "springs": []})",
            ": masses[0].position: ", "three numbers"},
           {materials + R"("masses": [{"position": [0,0,0], "mass": -1}], "springs": []})",
            ": masses[0].mass: ", "-1 is out of range; expected at least"},
           {materials + R"("masses": [{"position": [0,0,0], "mass": 0}], "springs": []})", ": masses: ", "0 kg"},
           {R"({"materials": [{"stiffness": 1, "amplitude": 0.91, "frequency": 1, "phase": 0}], )" + masses +
                R"(, "springs": []})",
            ": materials[0].amplitude: ", "0.91 is out of range; expected 0 to 0.9"},
           {materials + masses + R"(, "springs": [{"a": 0, "b": 2, "rest_length": 1, "material": 0}]})",
            ": springs[0].b: ", "2 is not a valid index"},
           {materials + masses +
                R"(, "springs": [{"a": 0, "b": 1, "rest_length": 1, "material": 0, "stiffness_factor": 0}]})",
            ": springs[0].stiffness_factor: ", "0"}}) {
    const std::string output = refusal(json);
    EXPECT_THAT(output, at_place("evodevo: " + (scratch_ / "own.json").string() + place, remedy));
    EXPECT_EQ(std::count(output.begin(), output.end(), '\n'), 1) << output;
    EXPECT_LT(output.size(), 600u);
    for (const char c : output) EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= ' ') << output;
  }
  EXPECT_THAT(simulate(tetrahedron("0.2", 500), {}, 2, "0.0003"), naming("--duration 0.0003", "0.0007 s"));
}

/// Returns the JSON of two masses, 1 m apart along x, joined by a spring of 1 m.
std::string pair_of_masses(const std::string& mass, const std::string& stiffness) {
  return R"({"masses": [{"position": [0, 0, 2], "mass": )" + mass +
         R"(}, {"position": [1, 0, 2], "mass": 0.2}], "springs": [{"a": 0, "b": 1, "rest_length": 1, "material": 0}],
             "materials": [{"stiffness": )" +
         stiffness + R"(, "amplitude": 0, "frequency": 0, "phase": 0}]})";
}

TEST_F(Simulate, AMassOf0KgIsHeldInPlace) {
  simulate(pair_of_masses("0", "5000"), {"--trajectory", csv_, "--set", "scene={gravity={}}"}, 0, "0.35");
  const std::vector<Seen> frames = trajectory_in(csv_);
  for (const Seen& seen : frames) EXPECT_EQ(seen.position[0], frames.front().position[0]);
  // a pendulum of 1 m passes the time 0.35 s at the angle at which its energy is that of its speed
  const Vec3 hung = frames.back().position[1], hook = frames.back().position[0], speed = frames.back().velocity[1];
  EXPECT_NEAR(norm(hung - hook), 1, 0.01);
  EXPECT_NEAR(norm(speed) * norm(speed) / 2, 9.81 * (hook.z - hung.z), 0.02);
  EXPECT_GT(hook.z - hung.z, 0.4);
}

TEST_F(Simulate, ABodyThatNoStepSuitsIsToldWhatToDo) {
  EXPECT_THAT(simulate(pair_of_masses("0.2", "1e15"), {"--set", "simulation.dt=auto"}, 2),
              AllOf(naming("own.json: invalid: unstable dt: ", "softer"), ::testing::Not(HasSubstr("simulation.dt"))));
  EXPECT_THAT(simulate(pair_of_masses("0.2", "1e15"), {}, 2),
              naming("own.json: invalid: unstable dt: ", "simulation.dt"));
}

TEST_F(Simulate, ATrajectoryThatASignalEndsLeavesNothingAndSaysSo) {
  const std::string body = scratch_.write("own body.json", tetrahedron("0.2", 500));
  fs::create_directory(folder_);
  for (const int signal : {SIGINT, SIGTERM}) {
    Process process(program({"simulate", body, file_, "--duration", "700000", "--trajectory", folder_ + "/t.csv"}));
    while (fs::is_empty(folder_)) std::this_thread::yield();
    process.send(signal);
    EXPECT_EQ(process.wait(), 128 + signal);
    EXPECT_THAT(process.output(), HasSubstr(folder_ + "/t.csv is not written\n"));
    EXPECT_TRUE(fs::is_empty(folder_));
  }
}

TEST_F(Simulate, ATrajectoryNeverTakesThePlaceOfWhatIsRead) {
  const std::string body = scratch_.write("own body.json", tetrahedron("0.2", 500));
  const std::string soft = (scratch_ / "soft.csv").string(), hard = (scratch_ / "hard.csv").string();
  const std::string roundabout = (scratch_ / "." / "run" / ".." / "own body.json").string();
  fs::create_directory(folder_);
  fs::create_symlink(body, soft);
  fs::create_hard_link(file_, hard);
  const Words words{"simulate", body, file_, "--duration", "0.1", "--trajectory"};
  for (const std::string& csv : {body, file_, soft, hard, roundabout})
    EXPECT_THAT(testing::refusal(joined(words, {csv})), naming("--trajectory " + csv, "name another file"));
  said(joined(words, {csv_}));  // and both are what they were
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
