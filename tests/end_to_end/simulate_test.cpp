// The command `evodevo simulate`: bodies taken from a run move as they did in that run, and unsuitable bodies and
// options are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "analysis/ground.hpp"
#include "evolution/archive/archive.hpp"
#include "life/evaluation.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::Finished;
using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

Finished evodevo(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), EVODEVO_PROGRAM);
  return testing::run(arguments);
}

/// Returns an experiment with rough ground, a payload and time steps that are not powers of two.
std::string awkward_experiment() {
  std::string text = testing::small_experiment;
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
  testing::Scratch scratch_;
  std::string file_ = scratch_.write("two bodies (rough).toml", awkward_experiment());
  std::string folder_ = (scratch_ / "run").string();
  std::string csv_ = (scratch_ / "t.csv").string();

  void run() {
    const Finished finished = evodevo({"run", file_, "--out", folder_, "--set", "experiment.verify=0"});
    ASSERT_EQ(finished.exit_code, 0) << finished.output;
  }

  /// Writes the output of a command to a file, and returns its path.
  std::string printed(std::vector<std::string> arguments) {
    const Finished finished = evodevo(std::move(arguments));
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    return scratch_.write("body.json", finished.output);
  }

  /// Simulates a body for 14 steps, which is less than the time between two frames; returns the first and the last
  /// state.
  std::pair<Seen, Seen> simulated(const std::string& body) {
    const Finished finished = evodevo({"simulate", body, file_, "--duration", "0.0098", "--trajectory", csv_});
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    EXPECT_THAT(finished.output, HasSubstr("\nafter 0.0098 s the centre")) << "however old it was before";
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

  Finished simulate(const std::string& json, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"simulate", scratch_.write("own.json", json), file_, "--duration", "0.1"});
    return evodevo(more);
  }
};

TEST_F(Simulate, ANewbornLivesAsInItsRunUnderItsLoadAndOnItsGround) {
  run();
  const auto life = again();
  const State born = life->lives.front().living.state;
  const auto [first, last] = simulated(printed({"body", folder_}));
  expect_same_bits(first, born);
  expect_same_bits(last, life->go_on().living.state);
}

TEST_F(Simulate, AMaturedBodyGoesOnAsInItsRun) {
  run();
  const auto life = again();
  life->evaluation.development.run(life->lives, [](double) {});
  const LivingBody& matured = life->lives.front().living;
  const std::string body = printed({"body", folder_, "--matured"});
  const Json json = Json::parse(std::ifstream(body));
  EXPECT_EQ(json.at("time").get<double>(), matured.state.time);
  EXPECT_EQ(json.at("start_energy").get<double>(), matured.state.start_energy);
  double own = 0, written = 0;
  for (const Mass& mass : matured.body.masses) own += mass.mass;
  for (const Json& mass : json.at("masses")) written += mass.at("mass").get<double>();
  EXPECT_EQ(written, own) << "its load is on it and comes on it only once";
  const State before = matured.state;
  const auto [first, last] = simulated(body);
  expect_same_bits(first, before);
  EXPECT_THAT(before.velocity, ::testing::Contains(::testing::Ne(Vec3{})));
  expect_same_bits(last, life->go_on().living.state);
}

TEST_F(Simulate, ABodyThatGrewInAnotherSceneGoesOnToo) {
  const Finished grown = evodevo({"environments", file_, "--starts", "1", "--json"});
  ASSERT_EQ(grown.exit_code, 0) << grown.output;
  const Json body = Json::parse(grown.output).at(0).at("scenes").at(0).at("starts").at(0).at("body");
  const auto [first, last] = simulated(scratch_.write("grown.json", body.dump()));
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
    const std::string body = scratch_.write("own.json", tetrahedron("0.2", 500, "", "", z));
    const Finished finished = evodevo(
        {"simulate", body, file_, "--duration", "0.1", "--trajectory", csv_, "--set", "scene.floor.roughness=0.5"});
    ASSERT_EQ(finished.exit_code, 0) << finished.output;
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
  const auto at = [&](double z) { return simulate(tetrahedron("0.2", 500, "", R"(, "time": 1.5)", z)); };
  const Finished deep = at(-0.4);
  EXPECT_EQ(deep.exit_code, 2);
  EXPECT_THAT(deep.output, AllOf(HasSubstr("own.json: invalid: "), HasSubstr("ground"), HasSubstr(" J"),
                                 HasSubstr("leave out \"time\"")));
  EXPECT_EQ(at(0.5).exit_code, 0) << "it falls";
}

TEST_F(Simulate, TheStepIsJudgedByTheBodysOwnMassesAndMaterials) {
  const std::vector<std::string> too_light_an_encoding = {"--set", "encoding.mass=0.002"};
  EXPECT_EQ(evodevo({"check", file_, "--set", "encoding.mass=0.002"}).exit_code, 2);
  EXPECT_EQ(simulate(tetrahedron("0.5", 500), too_light_an_encoding).exit_code, 0)
      << "no mass of this body is that light";
  EXPECT_EQ(simulate(tetrahedron("0.5", 500), {"--set", "materials.bone.stiffness=1e9"}).exit_code, 0)
      << "nothing of this body is bone";
  const Finished stiff = simulate(tetrahedron("0.5", 2e7)), light = simulate(tetrahedron("0.002", 500));
  EXPECT_EQ(stiff.exit_code, 2);
  EXPECT_THAT(stiff.output,
              AllOf(HasSubstr("invalid: unstable dt: 0.0007 s"), HasSubstr("springs"), HasSubstr("simulation.dt")));
  EXPECT_EQ(light.exit_code, 2);
  EXPECT_THAT(light.output, HasSubstr("lightest mass"));
}

TEST_F(Simulate, ABodyThatDivergesIsAFailure) {
  const Finished finished = simulate(tetrahedron("0.5", 2e7), {"--set", "simulation.unstable=run"});
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output, HasSubstr("diverged after "));
}

TEST_F(Simulate, WhatIsUnstableRunsWhereTheFileAsksForIt) {
  const std::vector<std::string> run = {"--set", "simulation.unstable=run"};
  const Finished light = simulate(tetrahedron("0.002", 500), run);
  EXPECT_THAT(light.output, testing::naming("4 masses, 6 springs", "cpu")) << "whatever becomes of it";
  std::vector<std::string> of_encoding = run;
  of_encoding.insert(of_encoding.end(), {"--set", "encoding.mass=0.002"});
  EXPECT_EQ(simulate(tetrahedron("0.5", 500), of_encoding).exit_code, 0);
  of_encoding.insert(of_encoding.begin(), {"check", file_});
  EXPECT_EQ(evodevo(of_encoding).exit_code, 0) << "nor does the experiment refuse what it asks for";
}

TEST_F(Simulate, OnlyALifeUnderWayHasVelocities) {
  const std::string velocity = R"(, "velocity": [0, 1.5, 0])";
  const Finished newborn = simulate(tetrahedron("0.2", 500, velocity));
  EXPECT_EQ(newborn.exit_code, 2);
  EXPECT_THAT(newborn.output, AllOf(HasSubstr("masses[0].velocity"), HasSubstr("\"time\"")));
  const std::string body = scratch_.write("thrown.json", tetrahedron("0.2", 500, velocity, R"(, "time": 0)", 3));
  const Finished thrown = evodevo({"simulate", body, file_, "--duration", "0.1", "--trajectory", csv_, "--set",
                                   "scene={gravity={}}", "--set", "simulation.precision=double"});
  ASSERT_EQ(thrown.exit_code, 0) << thrown.output;
  Vec3 moved;
  const std::vector<Seen> frames = trajectory_in(csv_);
  for (std::size_t i = 0; i < 4; ++i) moved = moved + 0.25 * (frames.back().position[i] - frames.front().position[i]);
  EXPECT_NEAR(moved.y, 1.5 * 0.1, 1e-3);
  EXPECT_NEAR(moved.z, -9.81 / 2 * 0.01, 1e-3);
}

TEST_F(Simulate, KeysThatAreUnknownOrStandTwiceAreRefused) {
  const auto refusal = [&](const std::string& json) {
    const Finished finished = simulate(json);
    EXPECT_EQ(finished.exit_code, 2) << json;
    EXPECT_EQ(std::count(finished.output.begin(), finished.output.end(), '\n'), 1) << finished.output;
    EXPECT_LT(finished.output.size(), 600u);
    for (const char c : finished.output) EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= ' ') << json;
    return finished.output;
  };
  EXPECT_THAT(refusal(tetrahedron("0.2", 500, R"(, "velocty": [0, 0, 0])")),
              AllOf(HasSubstr("masses[0].velocty"), HasSubstr("did you mean \"velocity\"?")));
  EXPECT_THAT(refusal(tetrahedron("0.2", 500, "", R"(, "colour": "red")")),
              AllOf(HasSubstr("colour: "), HasSubstr("known: ")));
  EXPECT_THAT(refusal(tetrahedron("0.2", 500, R"(, "mass": 0.3)")),
              AllOf(HasSubstr("masses[0].mass"), HasSubstr("twice")));
  EXPECT_THAT(refusal(tetrahedron("0.2", 500, "", R"(, "masses": [])")),
              AllOf(HasSubstr("masses: "), HasSubstr("twice")));
  EXPECT_THAT(refusal(tetrahedron("0.2", 500, "", R"(, "\u001b[31mred": 1)")), HasSubstr("\\u001b[31mred"));
  EXPECT_THAT(refusal(tetrahedron("0.2", 500, "", ", \"" + std::string(5000, 'k') + "\": 1")), HasSubstr("kkk..."));
  EXPECT_THAT(refusal(tetrahedron("0.2", 500, "", ", \"time\": " + std::string(100000, '['))), HasSubstr("levels"));
  EXPECT_THAT(refusal(tetrahedron("0.2", 500, "", R"(, "time": -1)")), AllOf(HasSubstr("time"), HasSubstr("-1")));
  EXPECT_THAT(refusal("[1]"), testing::naming("object"));
}

TEST_F(Simulate, ADurationBelowAStepIsRefused) {
  const std::string body = scratch_.write("own.json", tetrahedron("0.2", 500));
  const Finished finished = evodevo({"simulate", body, file_, "--duration", "0.0003"});
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, AllOf(HasSubstr("--duration 0.0003"), HasSubstr("0.0007 s")));
}

TEST_F(Simulate, ATrajectoryNeverTakesThePlaceOfWhatIsRead) {
  const std::string text = tetrahedron("0.2", 500), body = scratch_.write("own body.json", text);
  const std::string soft = (scratch_ / "soft.csv").string(), hard = (scratch_ / "hard.csv").string();
  const std::string roundabout = (scratch_ / "." / "run" / ".." / "own body.json").string();
  fs::create_directory(folder_);
  fs::create_symlink(body, soft);
  fs::create_hard_link(file_, hard);
  for (const std::string& csv : {body, file_, soft, hard, roundabout}) {
    const Finished finished = evodevo({"simulate", body, file_, "--duration", "0.1", "--trajectory", csv});
    EXPECT_EQ(finished.exit_code, 2) << csv;
    EXPECT_THAT(finished.output, AllOf(HasSubstr("--trajectory " + csv), HasSubstr("name another file")));
  }
  EXPECT_EQ(evodevo({"simulate", body, file_, "--duration", "0.1", "--trajectory", csv_}).exit_code, 0)
      << "and both are what they were";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
