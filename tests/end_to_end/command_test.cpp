// The commands as a user types them: their output, exit codes, and files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/text.hpp"
#include "evolution/evolution.hpp"
#include "support/elsewhere.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using testing::Finished;
using ::testing::HasSubstr;
using testing::small_experiment;

Finished evodevo(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), EVODEVO_PROGRAM);
  return testing::run(arguments);
}

/// Provides a finished run of the small experiment.
class Command : public ::testing::Test {
 protected:
  testing::Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", small_experiment);
  std::string folder_ = (scratch_ / "run").string();

  void run_small() {
    const Finished finished = evodevo({"run", file_, "--out", folder_});
    ASSERT_EQ(finished.exit_code, 0) << finished.output;
  }
};

TEST_F(Command, RunSaysWhereOnWhatAndHowFast) {
  const Finished finished = evodevo({"run", file_, "--out", folder_, "--device", "cpu"});
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("small on cpu"));
  EXPECT_THAT(finished.output, HasSubstr("writing " + folder_));
  EXPECT_THAT(finished.output, HasSubstr("generation 3  evaluations 24/24"));
  EXPECT_THAT(finished.output, HasSubstr("best: individual"));
  EXPECT_THAT(finished.output, HasSubstr("spring evaluations/s"));
  for (const char* part : {"time:  simulate", "develop", "decode", "breed", "select", "archive"})
    EXPECT_THAT(finished.output, ContainsRegex(part + std::string(" [0-9]+ %")));
}

TEST_F(Command, ShowTellsWhichBlocksCameWithEachChild) {
  const Finished run =
      evodevo({"run", file_, "--out", folder_, "--set", "encoding={name = 'neat'}", "--set", "mutation.0.name=add-node",
               "--set", "mutation.0.probability=1", "--set", "crossover.0.probability=0"});
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(evodevo({"show", folder_}).output,
              ContainsRegex("[0-9]+ .add-node: .1 node, .2 link. < [0-9]+ .random.\n"));
}

TEST_F(Command, ShowAgreesWithTheArchive) {
  run_small();
  const Finished shown = evodevo({"show", folder_, "--json"});
  ASSERT_EQ(shown.exit_code, 0) << shown.output;
  const auto json = nlohmann::json::parse(shown.output);
  ASSERT_EQ(json.at("generations").size(), 4u);
  double best = -1e300;
  std::int64_t failed = 0, clones = 0;
  for (const auto& generation : json.at("generations")) {
    for (const char* key : {"generation", "evaluations", "best", "median", "diverged", "invalid", "clones"})
      ASSERT_TRUE(generation.contains(key)) << key;
    failed += generation.at("diverged").get<int>() + generation.at("invalid").get<int>();
    clones += generation.at("clones").get<int>();
    if (!generation.at("best").is_null()) best = std::max(best, generation.at("best").get<double>());
  }
  EXPECT_EQ(json.at("generations").back().at("evaluations"), 24);
  const auto& champion = json.at("best");
  EXPECT_EQ(champion.at("status"), "ok");
  EXPECT_EQ(champion.at("objectives").at("distance").get<double>(), best);
  for (const char* key : {"individual", "generation", "age", "parents"}) EXPECT_TRUE(champion.contains(key)) << key;
  EXPECT_EQ(json.at("statuses").at("ok").get<int>() + failed, 24);

  const Finished text = evodevo({"show", folder_});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.output, HasSubstr("24 evaluations"));
  EXPECT_EQ(json.at("clones"), clones);
  EXPECT_THAT(text.output, HasSubstr(std::to_string(clones) + " of them clones"));
  EXPECT_THAT(text.output,
              HasSubstr("best individuals in distance\n  " + champion.at("individual").dump() + ": distance"));
  EXPECT_THAT(text.output, ::testing::Not(HasSubstr("nan")));
}

TEST_F(Command, ARunThatVerifiesItsFrontTellsWhomItRefuses) {
  const Finished finished = evodevo({"run", file_, "--out", folder_, "--set", "experiment.verify_front=true"});
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, ContainsRegex("artefact or passive [0-9.]+ %"));
  EXPECT_THAT(finished.output, ContainsRegex("time: .*, verify [0-9]+ %"));
  const auto json = nlohmann::json::parse(evodevo({"show", folder_, "--json"}).output);
  const Finished text = evodevo({"show", folder_});
  std::int64_t told = 0, refused = 0;
  for (const char* status : {"artefact", "passive"}) {
    const auto count = json.at("statuses").at(status).get<std::int64_t>();
    refused += count;
    for (const auto& generation : json.at("generations")) told += generation.at(status).get<std::int64_t>();
    EXPECT_THAT(text.output, HasSubstr(std::to_string(count) + " " + status));
  }
  ASSERT_GT(refused, 0);
  EXPECT_EQ(told, refused);
  for (const auto& failure : json.at("failures"))
    EXPECT_THAT(text.output,
                HasSubstr(failure.at("status").get<std::string>() + ": " + failure.at("reason").get<std::string>()));
}

TEST_F(Command, FailedBodiesNeverReachAReportAsNumbers) {
  // gravity and drag too strong for this time step: every valid body diverges
  const Finished finished = evodevo({"run", file_, "--out", folder_, "--set", "scene.drag.coefficient=1e6", "--set",
                                     "scene.gravity.acceleration=1000"});
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("best none  median none"));
  EXPECT_THAT(finished.output, testing::naming("no individual", "fitness", " show " + folder_));
  const auto json = nlohmann::json::parse(evodevo({"show", folder_, "--json"}).output);
  EXPECT_TRUE(json.at("best").is_null());
  EXPECT_TRUE(json.at("generations")[0].at("best").is_null());
  EXPECT_TRUE(json.at("generations")[0].at("median").is_null());
  EXPECT_GT(json.at("statuses").at("diverged").get<int>(), 0);
  EXPECT_EQ(json.at("statuses").at("ok"), 0);
  std::int64_t failed = 0;
  for (const auto& failure : json.at("failures")) failed += failure.at("count").get<std::int64_t>();
  EXPECT_EQ(failed, json.at("evaluations")) << "reasons that differ in numbers alone are one, and none is left out";
  EXPECT_LT(json.at("failures").size(), 5u);
  const Finished shown = evodevo({"show", folder_});
  EXPECT_EQ(shown.exit_code, 0);
  EXPECT_THAT(shown.output, HasSubstr(" diverged: " + json.at("failures")[0].at("reason").get<std::string>()));
  EXPECT_THAT(shown.output, Not(HasSubstr("best individuals")));
  EXPECT_EQ(evodevo({"body", folder_}).exit_code, 2);
}

TEST_F(Command, FailedBodiesLoseToAnyFiniteOne) {
  // with bone this stiff, a pair of masses is stable but a block of bone is not
  for (const std::string selection : {"age-fitness-pareto", "pareto-layers", "elitist"}) {
    const std::string folder = folder_ + selection;
    const Finished finished = evodevo({"run", file_, "--out", folder, "--set", "materials.bone.stiffness=1e6", "--set",
                                       "experiment.evaluations=90", "--set", "experiment.random_individuals=3", "--set",
                                       "selection.name=" + selection});
    ASSERT_EQ(finished.exit_code, 0) << finished.output;
    const Archive archive = Archive::read(folder);
    ASSERT_GT(archive.statuses().at("invalid"), 3) << "there must be something to lose";
    EXPECT_EQ(archive.individual(archive.best(1).at(0))->result.status, Status::ok);
    const auto population = archive.population();
    ASSERT_GT(archive.statuses().at("ok"), static_cast<std::int64_t>(population.size()));
    for (const Individual& individual : population) EXPECT_EQ(individual.result.status, Status::ok) << selection;
  }
}

using Pair = std::pair<std::uint32_t, std::uint32_t>;
using Pairs = std::set<Pair>;

Pair pair_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

TEST_F(Command, LifeTellsEveryEditFromBirthToTheMaturedBody) {
  run_small();
  const auto json_of = [&](std::vector<std::string> arguments) {
    const Finished finished = evodevo(std::move(arguments));
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    return nlohmann::json::parse(finished.output);
  };
  const auto born = json_of({"body", folder_}), matured = json_of({"body", folder_, "--matured"});
  const auto life = json_of({"life", folder_, "--json"});
  EXPECT_EQ(life.at("born").at("springs"), born.at("springs").size());
  EXPECT_EQ(life.at("matured").at("springs"), matured.at("springs").size());

  const auto pairs_of = [](const nlohmann::json& body) {
    Pairs pairs;
    for (const auto& spring : body.at("springs")) pairs.insert(pair_of(spring.at("a"), spring.at("b")));
    return pairs;
  };
  Pairs pairs = pairs_of(born);  // no masses are added or removed, so each mass's number equals its index
  ASSERT_EQ(life.at("edits").size(), 2u * (2 + 2)) << "two springs for two others in each of two cycles";
  for (const auto& edit : life.at("edits")) {
    EXPECT_EQ(edit.at("operator"), "spring-turnover");
    EXPECT_EQ(edit.at("operator_index"), 0);
    const auto spring = pair_of(edit.at("spring")[0], edit.at("spring")[1]);
    if (edit.at("event") == "gone") {
      EXPECT_EQ(pairs.erase(spring), 1u);
      EXPECT_GE(edit.at("cause").get<double>(), 0);
      EXPECT_EQ(edit.at("measure"), "mean-force");
      EXPECT_EQ(edit.at("unit"), "N");
    } else {
      EXPECT_TRUE(pairs.insert(spring).second);
      EXPECT_FALSE(edit.contains("cause")) << "it came anywhere";
    }
  }
  const auto& operators = life.at("operators");
  ASSERT_EQ(operators.size(), 1u);
  EXPECT_EQ(operators[0].at("name"), "spring-turnover");
  EXPECT_EQ(pairs, pairs_of(matured));

  const std::string id = life.at("individual").dump();
  const Finished text = evodevo({"life", folder_, "--all", "--individual", id});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.output, ContainsRegex("cycle 2  spring-turnover: spring [0-9]+-[0-9]+ gone, mean-force [^ ]+ N\n"));
  EXPECT_THAT(text.output, HasSubstr("individual " + id + ": born with 12 masses"));
  EXPECT_THAT(text.output, ::testing::Not(HasSubstr("warning"))) << "lived again to the same bits";
  const std::string summary = evodevo({"life", folder_, "--individual", id}).output;
  EXPECT_THAT(summary, ContainsRegex("cycle 2  spring-turnover: 2 springs gone \\(mean-force [^ ]+ to [^ ]+ N\\), "
                                     "2 springs come\n"));
  EXPECT_THAT(summary, ::testing::Not(HasSubstr("spring-turnover: spring ")));
}

TEST_F(Command, AYokedLifeIsLivedAgainToTheSameBits) {
  const Finished run =
      evodevo({"run", file_, "--out", folder_, "--set", "development.control=random-places", "--threads", "1"});
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const Finished life = evodevo({"life", folder_, "--all"});
  EXPECT_EQ(life.exit_code, 0);
  EXPECT_THAT(life.output, HasSubstr("cycle 2  spring-turnover: spring "));
  EXPECT_THAT(life.output, ::testing::Not(HasSubstr("warning")));
  const auto verification =
      nlohmann::json::parse(evodevo({"show", folder_, "--json"}).output).at("best").at("verification");
  EXPECT_EQ(verification.at("trials")[0].at("trial"), "again");
  EXPECT_EQ(verification.at("trials")[0].at("value"), verification.at("fitness"));
}

TEST_F(Command, LifeTellsOperatorsOfOneNameApartAndTalliesFromForces) {
  std::string twice = small_experiment;
  twice.insert(twice.find("[[fitness]]"), "[[development.operator]]\nname = \"spring-turnover\"\nsprings = 1\n");
  const std::string file = scratch_.write("twice.toml", twice);
  ASSERT_EQ(
      evodevo({"run", file, "--out", folder_, "--set", "development.probe=skip-shift", "--set", "development.skip=10"})
          .exit_code,
      0);
  const Finished text = evodevo({"life", folder_, "--all"});
  for (const char* op : {"spring-turnover \\(operator 0\\)", "spring-turnover \\(operator 1\\)"})
    EXPECT_THAT(text.output,
                ContainsRegex(std::string(op) + ": spring [0-9]+-[0-9]+ gone, skip-shift -?[0-9]+ points"));
}

TEST_F(Command, LifeTellsWhyMassesGoAndHowFarSpringsGrow) {
  std::string text = small_experiment;
  const std::string turnover = "name = \"spring-turnover\"\nsprings = 2";
  text.replace(text.find(turnover), turnover.size(),
               "name = \"mass-turnover\"\nthreshold = 100\nlimit = 1\nsprings = 4\nwhere = \"by-stress\"\n"
               "[[development.operator]]\nname = \"ballistic-growth\"");
  const Finished run =
      evodevo({"run", scratch_.write("growing.toml", text), "--out", folder_, "--set", "encoding.size_range=0.25",
               "--set", "development.probe=skip-shift", "--set", "development.skip=10"});
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const std::string life = evodevo({"life", folder_, "--all"}).output;
  EXPECT_THAT(life, ContainsRegex("cycle 1  mass-turnover: mass [0-9]+ gone, degree [0-9]+ springs\n"));
  EXPECT_THAT(life, ContainsRegex("cycle 1  mass-turnover: mass 12 come, skip-shift -?[0-9]+ points at "));
  EXPECT_THAT(life, ContainsRegex("cycle 1  ballistic-growth: springs .*from 0 to 0.5 "));
  EXPECT_THAT(life, ContainsRegex("cycle 2  ballistic-growth: springs .*from 0.5 to 1 "));
  const std::string summary = evodevo({"life", folder_}).output;
  EXPECT_THAT(summary,
              ContainsRegex("cycle 1  mass-turnover: 1 mass gone \\(degree [0-9]+ springs\\), .*1 mass come "));
  EXPECT_THAT(summary, ContainsRegex("cycle 2  ballistic-growth: springs .*from 0.5 to 1 "));
  int masses_gone = 0, growth = 0;
  const auto json = nlohmann::json::parse(evodevo({"life", folder_, "--json"}).output);
  for (const auto& edit : json.at("edits")) {
    if (edit.at("event") == "growth") {
      EXPECT_EQ(edit.at("from"), growth++ * 0.5);
      EXPECT_EQ(edit.at("to"), growth * 0.5);
      EXPECT_FALSE(edit.contains("mass") || edit.contains("spring"));
    } else if (edit.contains("mass") && edit.at("event") == "gone") {
      ++masses_gone;
      EXPECT_EQ(edit.at("measure"), "degree");
      EXPECT_EQ(edit.at("unit"), "springs");
      EXPECT_GE(edit.at("cause").get<double>(), 1);
    }
  }
  EXPECT_EQ(masses_gone, 2);
  EXPECT_EQ(growth, 2);
}

TEST_F(Command, LifeSaysWhereItCannotBeSure) {
  const Experiment experiment = testing::read(small_experiment);
  testing::Elsewhere simulator(experiment, "another device");
  Archive archive = Archive::create(folder_, experiment, simulator.device());
  evolve(experiment, simulator, archive, false, Observer{});
  for (std::uint32_t id = 0; id < 24; ++id) {
    const Finished finished = evodevo({"life", folder_, "--individual", std::to_string(id)});
    EXPECT_EQ(finished.exit_code, 0);
    const std::string warning = "warning: individual " + std::to_string(id) + " ";
    const bool warns = finished.output.find(warning) != std::string::npos;
    EXPECT_EQ(warns, !archive.life(id).has_value()) << finished.output;
    const Finished body = evodevo({"body", folder_, "--matured", "--individual", std::to_string(id)});
    EXPECT_EQ(body.output.find(warning) != std::string::npos, warns) << body.output;
  }
}

TEST_F(Command, WhatWasRecordedOfALifeHappensAgain) {
  run_small();
  Archive archive = Archive::annotate(folder_);
  std::string experiment = archive.record("experiment");
  experiment.replace(experiment.find("seed = 7"), 8, "seed = 8");
  const std::vector<std::string> life{"life", folder_, "--json"}, body{"body", folder_, "--matured"};
  const Finished life_before = evodevo(life), body_before = evodevo(body);
  EXPECT_EQ(life_before.exit_code, 0);
  EXPECT_EQ(body_before.exit_code, 0);
  archive.set_record("experiment", experiment);
  EXPECT_EQ(evodevo(life).output, life_before.output) << "whatever the operators would do";
  EXPECT_EQ(evodevo(body).output, body_before.output);
}

TEST_F(Command, ARunOnAGpuCanBeLookedAtWithoutOne) {
  run_small();
  Archive archive = Archive::annotate(folder_);
  std::string experiment = archive.record("experiment");
  const std::string automatic = "device = 'auto'";
  ASSERT_NE(experiment.find(automatic), std::string::npos);
  archive.set_record("experiment", experiment.replace(experiment.find(automatic), automatic.size(), "device = 'cuda'"));
  for (const char* matured : {"", "--matured"}) {
    std::vector<std::string> arguments{"body", folder_};
    if (*matured != 0) arguments.emplace_back(matured);
    EXPECT_EQ(evodevo(arguments).exit_code, 0) << matured;
  }
  EXPECT_EQ(evodevo({"life", folder_}).exit_code, 0);
}

TEST_F(Command, ARunVerifiesItsBestAndMoreAreVerifiedAtWill) {
  run_small();
  const auto verification = [&] {
    return nlohmann::json::parse(evodevo({"show", folder_, "--json"}).output).at("best").at("verification");
  };
  const auto of_run = verification();
  ASSERT_FALSE(of_run.is_null());
  EXPECT_EQ(of_run.at("trials").size(), 11u) << "it develops";
  const Finished verified = evodevo({"verify", folder_, "--best", "2", "--json"});
  ASSERT_EQ(verified.exit_code, 0) << verified.output;
  const auto json = nlohmann::json::parse(verified.output);
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0], of_run) << "the same every time";
  EXPECT_EQ(verification(), of_run);
  const Finished text = evodevo({"verify", folder_});
  EXPECT_THAT(text.output, HasSubstr("individual " + json[0].at("individual").dump() + ": distance"));
  EXPECT_THAT(text.output, HasSubstr("  quarter-step "));
  const std::string mark = of_run.at("marks").empty() ? "verified" : of_run.at("marks")[0].get<std::string>();
  EXPECT_THAT(evodevo({"show", folder_}).output, HasSubstr(", " + mark));
  EXPECT_THAT(evodevo({"verify", folder_, "--best", "0"}).output, testing::naming("--best 0: ", "1 to 1000"));
}

TEST_F(Command, BodyComesOutAndGoesIntoAScene) {
  run_small();
  const Finished body = evodevo({"body", folder_});
  ASSERT_EQ(body.exit_code, 0) << body.output;
  const auto json = nlohmann::json::parse(body.output);
  ASSERT_FALSE(json.at("masses").empty());
  EXPECT_EQ(json.at("masses")[0].at("position").size(), 3u);
  EXPECT_EQ(json.at("masses")[0].at("mass"), 0.2);
  for (const char* key : {"a", "b", "rest_length", "material"}) EXPECT_TRUE(json.at("springs")[0].contains(key)) << key;
  EXPECT_EQ(json.at("materials")[0].at("name"), "air");
  EXPECT_EQ(evodevo({"body", folder_, "--individual", "999"}).exit_code, 2);

  const std::string body_file = scratch_.write("body.json", body.output);
  const std::string csv = (scratch_ / "t.csv").string();
  const Finished moved = evodevo({"simulate", body_file, file_, "--duration", "0.2", "--trajectory", csv});
  ASSERT_EQ(moved.exit_code, 0) << moved.output;
  std::ifstream stream(csv);
  std::string line;
  std::getline(stream, line);
  EXPECT_EQ(line, "time,mass,x,y,z,vx,vy,vz");
  std::size_t rows = 0;
  while (std::getline(stream, line)) ++rows;
  EXPECT_EQ(rows, 21 * json.at("masses").size());
}

TEST_F(Command, AMaturedBodyHasDeveloped) {
  run_small();
  const auto springs = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"body", folder_});
    return nlohmann::json::parse(evodevo(more).output).at("springs");
  };
  const auto born = springs({}), matured = springs({"--matured"});
  EXPECT_NE(born, matured);
  EXPECT_EQ(born.size(), matured.size()) << "as many springs come as go";
  EXPECT_EQ(matured, springs({"--matured"})) << "a life can be lived again";
}

TEST_F(Command, ATrajectoryIsAFall) {
  const std::string body = scratch_.write("one.json", R"({
    "masses": [{"position": [0, 0, 5], "mass": 1}, {"position": [1, 0, 5], "mass": 1}],
    "springs": [{"a": 0, "b": 1, "rest_length": 1, "material": 0}],
    "materials": [{"stiffness": 100, "amplitude": 0, "frequency": 0, "phase": 0}], "time": 0})");
  const std::string csv = (scratch_ / "t.csv").string();
  const Finished finished = evodevo({"simulate", body, file_, "--set", "scene={gravity={}}", "--set",
                                     "simulation.precision=double", "--duration", "0.5", "--trajectory", csv});
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  std::ifstream stream(csv);
  std::string line, last;
  while (std::getline(stream, line)) last = line;
  double time = 0, mass = 0, x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(last.c_str(), "%lf,%lf,%lf,%lf,%lf", &time, &mass, &x, &y, &z), 5);
  EXPECT_NEAR(time, 0.5, 1e-9);
  EXPECT_NEAR(z, 5 - 9.81 / 2 * 0.25, 2e-3);
  EXPECT_NEAR(x, 1, 1e-9);
}

TEST_F(Command, BadInputEndsWithTwoAndLeavesNothing) {
  const std::string bad = scratch_.write("bad.toml", "[experiment]\nseed = \"x\"\n");
  for (const char* command : {"run", "check"}) {
    const Finished finished = evodevo({command, bad});
    EXPECT_EQ(finished.exit_code, 2);
    EXPECT_THAT(finished.output, AllOf(HasSubstr("evodevo: " + bad + ":2:8: experiment.seed = \"x\": "),
                                       HasSubstr("0 to 9007199254740991")));
  }
  EXPECT_FALSE(fs::exists("runs/bad-1"));
  const Finished out = evodevo({"run", file_, "--out", folder_, "--threads", "-1"});
  EXPECT_EQ(out.exit_code, 2);
  EXPECT_THAT(out.output, AllOf(HasSubstr("--threads -1: simulation.threads = -1: "), HasSubstr("0 to 4096")));
  EXPECT_FALSE(fs::exists(folder_));
  EXPECT_THAT(evodevo({"run", file_, "--device", "gpu"}).output,
              AllOf(HasSubstr("--device gpu: simulation.device = \"gpu\": "), HasSubstr("auto, cpu, cuda")));
  for (const char* device : {"cuda:", "cuda:0,", "cuda:0,0", "cuda:-1", "cuda:x", "cuda:1 ", "cuda:99999999999"}) {
    const Finished refused = evodevo({"check", file_, "--device", device});
    EXPECT_EQ(refused.exit_code, 2) << device;
    EXPECT_THAT(refused.output, AllOf(HasSubstr("--device cuda:"), HasSubstr("numbers"), HasSubstr("cuda:0,2")));
  }
  EXPECT_EQ(evodevo({"check", file_, "--device", "cuda:0,2"}).exit_code, 0) << "check needs no GPU";
}

TEST_F(Command, AllErrorsOfAnExperimentAreToldWithTheirNumber) {
  std::string text = small_experiment;
  text.replace(text.find("seed = 7"), 8, "seed = -7");
  text.replace(text.find("edge"), 4, "egde");
  const std::string bad = scratch_.write("bad.toml", text);
  for (const char* command : {"run", "check"}) {
    const Finished finished = evodevo({command, bad, "--threads", "-1"});
    EXPECT_EQ(finished.exit_code, 2);
    std::istringstream lines(finished.output);
    std::vector<std::string> told;
    for (std::string line; std::getline(lines, line);) told.push_back(line);
    EXPECT_THAT(
        told, ::testing::ElementsAre(testing::at_place("evodevo: --threads -1: simulation.threads = -1: ", "0 to 4096"),
                                     testing::at_place("evodevo: " + bad + ":3:8: experiment.seed = -7: "),
                                     testing::at_place("evodevo: " + bad + ":11:1: encoding.egde: ", " edge,"),
                                     "evodevo: 3 errors"));
  }
  EXPECT_FALSE(fs::exists("runs/bad-1"));
}

TEST_F(Command, TextsOfARecordDisturbNoTerminal) {
  run_small();
  {
    Archive archive = Archive::annotate(folder_);
    for (const char* key : {"name", "created"}) archive.set_record(key, "ü\x1b[31m\n\x7f\u009b\xff");
  }
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"show", folder_}, {"show", folder_, "--json"}}) {
    std::istringstream lines(evodevo(command).output);
    for (std::string line; std::getline(lines, line);) EXPECT_EQ(line, printable(line, 5000));
  }
}

TEST_F(Command, UsageErrors) {
  EXPECT_EQ(evodevo({}).exit_code, 2);
  EXPECT_THAT(evodevo({"rum"}).output, AllOf(HasSubstr("\"rum\""), HasSubstr("did you mean \"run\"?")));
  EXPECT_THAT(evodevo({"run"}).output,
              testing::naming("EXPERIMENT.toml", "missing", "usage: evodevo run EXPERIMENT.toml"));
  EXPECT_THAT(evodevo({"conform"}).output, testing::naming("LIBRARY", "missing", "usage: evodevo conform LIBRARY"));
  EXPECT_EQ(evodevo({"run", file_, "--sead", "3"}).exit_code, 2);
  EXPECT_THAT(evodevo({"run", file_, "--sead", "3"}).output, testing::naming("--sead", "did you mean \"--seed\"?"));
  EXPECT_THAT(evodevo({"show", "runs/small-1", "--individual", "best"}).output,
              testing::naming("'best'", "--individual ID: show this individual"));
  EXPECT_THAT(evodevo({"check", file_, "--set", "simulation.dt=0.0003"}).output,
              testing::naming("development.cycle_time", "the nearest one is 0.0501 s", "simulation.dt"));
  EXPECT_THAT(evodevo({"run", file_, "--set", "seed"}).output, AllOf(HasSubstr("--set seed"), HasSubstr("key=value")));
  EXPECT_THAT(evodevo({"check", file_}).output, ::testing::EndsWith(file_ + ": ok\n"));
  EXPECT_EQ(evodevo({"run", "--help"}).exit_code, 0);
}

TEST_F(Command, CheckTellsTheTopSpeed) {
  const auto told = [&](std::vector<std::string> overrides) {
    std::vector<std::string> command{"check", file_};
    for (const std::string& one : overrides) command.insert(command.end(), {"--set", one});
    const Finished finished = evodevo(command);
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    return finished.output;
  };
  // robots of one or two voxels of 0.5 m
  EXPECT_THAT(told({"scene.damping.rate=8", "fitness.0.window=0.2"}),
              testing::naming("top speed: ", "0.6131 m/s", "0.6131 to 1.226 body lengths",
                              " 0.1226 to 0.2453 in the window of 0.2 s", " 0.5 to 1 m long"));
  EXPECT_THAT(told({"scene.damping.rate=8", "scene.gravity.slope=-10"}),
              testing::naming("top speed: ", "0.8167 m/s downhill", "0.3909 m/s uphill", ": downhill 0.8167 to "));
  EXPECT_THAT(told({"scene.gravity.slope=30"}), testing::naming("0.4554 m/s downhill", "nothing uphill"));
  EXPECT_THAT(told({"scene.damping.rate=0"}), testing::naming("top speed: ", "no damping", "muscles"));
  EXPECT_EQ(told({"scene.floor.roughness=0.001"}), file_ + ": ok\n");
}

TEST_F(Command, CheckTellsTheTopSpeedInEachScenario) {
  const std::string file = scratch_.write("scenarios.toml", small_experiment + R"(
[[scenario]]
name = "icy"
friction = { coefficient = 0 }
[[scenario]]
name = "rubber"
friction = { coefficient = 0.9 }
)");
  const std::string told = evodevo({"check", file}).output;
  EXPECT_THAT(told, testing::at_place("top speed in scenario rubber: ", "0.4392 m/s", file + ": ok\n"));
  EXPECT_THAT(told, ::testing::Not(HasSubstr("icy")));
}

TEST_F(Command, FaultyBodiesAreRefusedByPlace) {
  const auto refusal = [&](const std::string& json) {
    const std::string file = scratch_.write("faulty.json", json);
    const Finished finished = evodevo({"simulate", file, file_});
    EXPECT_EQ(finished.exit_code, 2);
    return finished.output.substr(("evodevo: " + file).size());
  };
  const std::string masses = R"("masses": [{"position": [0,0,0], "mass": 1}, {"position": [1,0,0], "mass": 1}])";
  const std::string materials = R"("materials": [{"stiffness": 1, "amplitude": 0, "frequency": 0, "phase": 0}])";
  EXPECT_THAT(refusal("{"), testing::at_place(": ", "JSON"));
  EXPECT_THAT(refusal("{\x1b\n\xff"), testing::at_place(": ", "JSON", "<U+001B>"));
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_THAT(refusal(deep), testing::at_place(": ", "16 levels"));
  EXPECT_THAT(refusal("{}"), testing::at_place(": ", "\"materials\"", "missing"));
  EXPECT_THAT(refusal("{" + materials + R"(, "masses": [{"position": [0,0], "mass": 1}], "springs": []})"),
              testing::at_place(": masses[0].position: ", "three numbers"));
  EXPECT_THAT(refusal("{" + materials + R"(, "masses": [{"position": [0,0,0], "mass": -1}], "springs": []})"),
              testing::at_place(": masses[0].mass: ", "-1", "expected at least"));
  EXPECT_THAT(
      refusal("{" + materials + "," + masses + R"(, "springs": [{"a": 0, "b": 2, "rest_length": 1, "material": 0}]})"),
      testing::at_place(": springs[0].b: ", "2", "index"));
  EXPECT_THAT(refusal("{" + materials + "," + masses +
                      R"(, "springs": [{"a": 0, "b": 1, "rest_length": 1, "material": 0, "stiffness_factor": 0}]})"),
              testing::at_place(": springs[0].stiffness_factor: ", "0"));
}

TEST_F(Command, OperatorsDescribeThemselves) {
  const auto json = nlohmann::json::parse(evodevo({"operators", "--kind", "devo", "--json"}).output);
  ASSERT_EQ(json.size(), 10u);
  EXPECT_EQ(json[8].at("name"), "spring-turnover") << "in alphabetical order";
  EXPECT_EQ(json[8].at("parameters")[0].at("default"), "125");
  const Finished described = evodevo({"describe", "spring-turnover"});
  EXPECT_EQ(described.exit_code, 0);
  EXPECT_THAT(described.output, HasSubstr("springs = 125"));
  EXPECT_THAT(evodevo({"describe", "spring-turnove"}).output,
              AllOf(HasSubstr("\"spring-turnove\""), HasSubstr("did you mean \"spring-turnover\"?")));
  EXPECT_THAT(evodevo({"operators", "--kind", "devos"}).output,
              AllOf(HasSubstr("--kind devos: "), HasSubstr("did you mean \"devo\"?")));
  for (const std::string whole : {"--markdown", "--failed"}) {
    const Finished refused = evodevo({"operators", whole, "--kind", "devo"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.output, testing::naming("--kind devo", whole, "leave one"));
  }
  EXPECT_EQ(evodevo({"operators", "--markdown", "--json"}).exit_code, 2);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
