// The commands as a user types them, on runs with scenarios too: their output, exit codes, and files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "archive/archive.hpp"
#include "base/text.hpp"
#include "evolution/evolution.hpp"
#include "support/elsewhere.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

class Command : public ::testing::Test {
 protected:
  /// Runs the small experiment, and returns the output.
  std::string run(const Words& values = {}) const {
    return said(joined({"run", file_, "--out", folder_, "--device", "cpu"}, setting(values)));
  }
  std::string show() const { return said({"show", folder_}); }
  nlohmann::json shown() const { return nlohmann::json::parse(said({"show", folder_, "--json"})); }

  Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", small_experiment);
  std::string folder_ = (scratch_ / "run").string();
};

TEST_F(Command, RunSaysWhereOnWhatAndHowFastAndShowAgreesWithTheArchive) {
  const std::string told = run();
  EXPECT_THAT(told, naming("small on cpu", "writing " + folder_, "generation 3  evaluations 24/24", "best: individual",
                           "spring evaluations/s"));
  for (const char* part : {"time:  simulate", "develop", "decode", "breed", "select", "archive"})
    EXPECT_THAT(told, ContainsRegex(part + std::string(" [0-9]+ %")));

  const auto json = shown();
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
  EXPECT_EQ(json.at("clones"), clones);
  const std::string text = show();
  EXPECT_THAT(text, naming("24 evaluations", std::to_string(clones) + " of them clones",
                           "best individuals in distance\n  " + champion.at("individual").dump() + ": distance"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
}

TEST_F(Command, ShowTellsWhichBlocksCameWithEachChild) {
  run({"encoding={name = 'neat'}", "mutation.0.name=add-node", "mutation.0.probability=1",
       "crossover.0.probability=0"});
  EXPECT_THAT(show(), ContainsRegex("[0-9]+ .add-node: .1 node, .2 link. < [0-9]+ .random.\n"));
}

TEST_F(Command, ARunThatVerifiesItsFrontTellsWhomItRefuses) {
  const std::string told = run({"experiment.verify_front=trials"});
  EXPECT_THAT(told, ContainsRegex("refused [0-9.]+ %"));
  EXPECT_THAT(told, ContainsRegex("time: .*, verify [0-9]+ %"));
  const auto json = shown();
  const std::string text = show();
  std::int64_t in_generations = 0, refused = 0;
  for (const char* status : {"artefact", "passive"}) {
    const auto count = json.at("statuses").at(status).get<std::int64_t>();
    refused += count;
    for (const auto& generation : json.at("generations")) in_generations += generation.at(status).get<std::int64_t>();
    EXPECT_THAT(text, HasSubstr(std::to_string(count) + " " + status));
  }
  ASSERT_GT(refused, 0);
  EXPECT_EQ(in_generations, refused);
  for (const auto& failure : json.at("failures"))
    EXPECT_THAT(text,
                HasSubstr(failure.at("status").get<std::string>() + ": " + failure.at("reason").get<std::string>()));
}

TEST_F(Command, FailedBodiesNeverReachAReportAsNumbers) {
  // gravity and drag too strong for this method and time step: every valid body diverges
  const Words extreme =
      setting({"scene.drag.coefficient=1e6", "scene.gravity.acceleration=1000", "simulation.method=rk4"});
  const std::string told = output_of(joined(program({"run", file_, "--out", folder_, "--device", "cpu"}), extreme), 3);
  EXPECT_THAT(told, naming("best none  median none", "no individual", "fitness", " show " + folder_));
  const auto json = shown();
  EXPECT_TRUE(json.at("best").is_null());
  EXPECT_TRUE(json.at("generations")[0].at("best").is_null());
  EXPECT_TRUE(json.at("generations")[0].at("median").is_null());
  EXPECT_GT(json.at("statuses").at("diverged").get<int>(), 0);
  EXPECT_EQ(json.at("statuses").at("ok"), 0);
  std::int64_t failed = 0;
  for (const auto& failure : json.at("failures")) failed += failure.at("count").get<std::int64_t>();
  EXPECT_EQ(failed, json.at("evaluations")) << "reasons that differ in numbers alone are one, and none is left out";
  EXPECT_LT(json.at("failures").size(), 5u);
  const std::string text = show();
  EXPECT_THAT(text, HasSubstr(" diverged: " + json.at("failures")[0].at("reason").get<std::string>()));
  EXPECT_THAT(text, Not(HasSubstr("best individuals")));
  refusal({"body", folder_});
}

TEST_F(Command, ABodyComesOutWithEveryEditOfItsLifeAndGoesIntoAScene) {
  run();
  const auto json_of = [](const Words& words) { return nlohmann::json::parse(said(words)); };
  const auto born = json_of({"body", folder_}), matured = json_of({"body", folder_, "--matured"});
  const auto life = json_of({"life", folder_, "--json"});
  EXPECT_EQ(born.at("masses")[0].at("position").size(), 3u);
  EXPECT_EQ(born.at("masses")[0].at("mass"), 0.2);
  for (const char* key : {"a", "b", "rest_length", "material"}) EXPECT_TRUE(born.at("springs")[0].contains(key)) << key;
  EXPECT_EQ(born.at("materials")[0].at("name"), "air");
  refusal({"body", folder_, "--individual", "999"});
  EXPECT_EQ(life.at("born").at("springs"), born.at("springs").size());
  EXPECT_EQ(life.at("matured").at("springs"), matured.at("springs").size());

  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  const auto pair_of = [](std::uint32_t a, std::uint32_t b) { return Pair(std::minmax(a, b)); };
  const auto pairs_of = [&](const nlohmann::json& body) {
    std::set<Pair> pairs;
    for (const auto& spring : body.at("springs")) pairs.insert(pair_of(spring.at("a"), spring.at("b")));
    return pairs;
  };
  std::set<Pair> pairs = pairs_of(born);  // no masses are added or removed, so each mass's number equals its index
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
  ASSERT_EQ(life.at("operators").size(), 1u);
  EXPECT_EQ(life.at("operators")[0].at("name"), "spring-turnover");
  EXPECT_EQ(pairs, pairs_of(matured));
  EXPECT_NE(pairs, pairs_of(born));

  const std::string id = life.at("individual").dump();
  const std::string text = said({"life", folder_, "--all", "--individual", id});
  EXPECT_THAT(text, ContainsRegex("cycle 2  spring-turnover: spring [0-9]+-[0-9]+ gone, mean-force [^ ]+ N\n"));
  EXPECT_THAT(text, HasSubstr("individual " + id + ": born with 12 masses"));
  EXPECT_THAT(text, Not(HasSubstr("warning"))) << "lived again to the same bits";
  const std::string summary = said({"life", folder_, "--individual", id});
  EXPECT_THAT(summary, ContainsRegex("cycle 2  spring-turnover: 2 springs gone \\(mean-force [^ ]+ to [^ ]+ N\\), "
                                     "2 springs come\n"));
  EXPECT_THAT(summary, Not(HasSubstr("spring-turnover: spring ")));

  const fs::path csv = scratch_ / "t.csv";
  said({"simulate", scratch_.write("body.json", born.dump()), file_, "--duration", "0.2", "--trajectory", csv});
  std::ifstream stream(csv);
  std::size_t lines = 0;
  for (std::string line; std::getline(stream, line);) ++lines;
  EXPECT_EQ(lines, 1 + 21 * born.at("masses").size());
}

TEST_F(Command, WhatCanNeverWalkIsToldByCheckAndByTheRun) {
  for (const auto& [values, told] : std::initializer_list<std::pair<Words, Words>>{
           {{R"(encoding.materials=["air"])"}, {"warning: none of the first 6 random robots", "body", "air"}},
           {{R"(encoding.materials=["bone","tissue"])"}, {"warning: none of the first 6 random robots", "muscle"}},
           {{"materials.muscle.amplitude=0", "materials.muscle2.amplitude=0"},
            {"warning: none of the first", "muscle"}},
           {{"scene={gravity={}}"}, {"warning: [scene]", "no floor"}}}) {
    const std::string checked = said(joined({"check", file_}, setting(values)));
    for (const std::string& part : told) EXPECT_THAT(checked, HasSubstr(part)) << values.front();
  }
  EXPECT_THAT(said({"check", file_}), Not(HasSubstr("warning")));
  const Words all_air{"run", file_, "--out", folder_, "--set", R"(encoding.materials=["air"])"};
  const std::string ended = output_of(program(all_air), 3);
  EXPECT_THAT(ended,
              naming("warning: none of the first 6", "no individual has a fitness", "invalid: ", "show " + folder_));
  EXPECT_THAT(ended, Not(HasSubstr("verifying")));
  EXPECT_THAT(output_of(program({"resume", folder_}), 3), HasSubstr("complete"));
}

TEST_F(Command, EachLineOfTheSummaryFitsATerminalAndEachCommandAShell) {
  const std::string file = scratch_.write("my exp.toml", small_experiment), folder = (scratch_ / "my run").string();
  const std::string told = said({"run", file, "--out", folder, "--set", "experiment.verify_front=trials"});
  EXPECT_THAT(told, naming("show '" + folder + "'\n", "body '" + folder + "' --individual ", "film '" + folder + "'"));
  std::istringstream lines(told.substr(told.find("speed: ")));
  for (std::string line; std::getline(lines, line) && !line.starts_with("verifying");)
    EXPECT_LE(line.size(), 80u) << line;
  const std::string complete = said({"resume", folder});
  EXPECT_THAT(complete, naming("show '" + folder + "'",
                               "'experiment.start=" + fs::path(folder).lexically_normal().string() + "'"));
  fs::create_directory(scratch_ / "exps");
  const std::string other = scratch_.write("exps/other.toml", small_experiment);
  said({"check", other, "--set", "experiment.start=" + folder});
}

TEST_F(Command, AYokedLifeIsLivedAgainToTheSameBits) {
  run({"development.control=random-places", "simulation.threads=1"});
  const std::string life = said({"life", folder_, "--all"});
  EXPECT_THAT(life, HasSubstr("cycle 2  spring-turnover: spring "));
  EXPECT_THAT(life, Not(HasSubstr("warning")));
  const auto verification = shown().at("best").at("verification");
  EXPECT_EQ(verification.at("trials")[0].at("trial"), "again");
  EXPECT_EQ(verification.at("trials")[0].at("value"), verification.at("fitness"));
}

TEST_F(Command, LifeTellsOperatorsOfOneNameApartAndTalliesFromForces) {
  std::string twice = small_experiment;
  twice.insert(twice.find("[[fitness]]"), "[[development.operator]]\nname = \"spring-turnover\"\nsprings = 1\n");
  file_ = scratch_.write("twice.toml", twice);
  run({"development.probe=skip-shift", "development.skip=10"});
  const std::string text = said({"life", folder_, "--all"});
  for (const std::string op : {"spring-turnover \\(operator 0\\)", "spring-turnover \\(operator 1\\)"})
    EXPECT_THAT(text, ContainsRegex(op + ": spring [0-9]+-[0-9]+ gone, skip-shift -?[0-9]+ points"));
}

TEST_F(Command, LifeTellsWhyMassesGoAndHowFarSpringsGrow) {
  std::string text = small_experiment;
  const std::string turnover = "name = \"spring-turnover\"\nsprings = 2";
  text.replace(text.find(turnover), turnover.size(),
               "name = \"mass-turnover\"\nthreshold = 100\nlimit = 1\nsprings = 4\nwhere = \"by-stress\"\n"
               "[[development.operator]]\nname = \"ballistic-growth\"");
  file_ = scratch_.write("growing.toml", text);
  run({"encoding.size_range=0.25", "development.probe=skip-shift", "development.skip=10"});
  const std::string life = said({"life", folder_, "--all"});
  for (const char* line :
       {"cycle 1  mass-turnover: mass [0-9]+ gone, degree [0-9]+ springs\n",
        "cycle 1  mass-turnover: mass 12 come, skip-shift -?[0-9]+ points at ",
        "cycle 1  ballistic-growth: .*from 0 to 0.5 .*\"growth\"", "cycle 2  ballistic-growth: .*from 0.5 to 1 "})
    EXPECT_THAT(life, ContainsRegex(line));
  const std::string summary = said({"life", folder_});
  for (const char* line : {"cycle 1  mass-turnover: 1 mass gone \\(degree [0-9]+ springs\\), .*1 mass come ",
                           "cycle 2  ballistic-growth: .*from 0.5 to 1 .*\"growth\""})
    EXPECT_THAT(summary, ContainsRegex(line));
  int masses_gone = 0, growth = 0;
  const auto json = nlohmann::json::parse(said({"life", folder_, "--json"}));
  for (const auto& edit : json.at("edits")) {
    if (edit.at("event") == "scaled") {
      EXPECT_EQ(edit.at("by"), "growth");
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
  std::map<bool, std::uint32_t> one;  // by whether its life has been recorded
  for (std::uint32_t id = 0; id < 24; ++id) one[!archive.lives(id).empty()] = id;
  ASSERT_EQ(one.size(), 2u);
  for (const auto& [is_recorded, id] : one)
    for (const Words& command : {Words{"life", folder_}, {"body", folder_, "--matured"}}) {
      const std::string output = said(joined(command, {"--individual", std::to_string(id)}));
      const std::string warning = "warning: individual " + std::to_string(id) + " ";
      EXPECT_EQ(output.find(warning) != std::string::npos, !is_recorded) << output;
    }
}

TEST_F(Command, LooksAtARunGoByItsRecordNeedNoGpuAndDisturbNoTerminal) {
  run();
  Archive archive = Archive::annotate(folder_);
  const auto change = [&](const std::string& from, const std::string& to) {
    std::string experiment = archive.record("experiment");
    ASSERT_NE(experiment.find(from), std::string::npos) << experiment;
    archive.set_record("experiment", experiment.replace(experiment.find(from), from.size(), to));
  };
  const Words life{"life", folder_, "--json"}, body{"body", folder_, "--matured"};
  const std::string life_before = said(life), body_before = said(body);
  change("seed = 7", "seed = 8");
  EXPECT_EQ(evodevo(life).output, life_before) << "whatever the operators would do";
  EXPECT_EQ(evodevo(body).output, body_before);

  change("device = 'cpu'", "device = 'cuda'");
  for (const Words& command : {body, {"body", folder_}, {"life", folder_}}) said(command);

  for (const char* key : {"name", "created"}) archive.set_record(key, "ü\x1b[31m\n\x7f\u009b\xff");
  for (const Words& command : {Words{"show", folder_}, {"show", folder_, "--json"}}) {
    std::istringstream lines(evodevo(command).output);
    for (std::string line; std::getline(lines, line);) EXPECT_EQ(line, printable(line, 5000));
  }
}

TEST_F(Command, ARunVerifiesItsBestAndMoreAreVerifiedAtWill) {
  run();
  const auto of_run = shown().at("best").at("verification");
  ASSERT_FALSE(of_run.is_null());
  EXPECT_EQ(of_run.at("trials").size(), 16u) << "it develops";
  const auto json = nlohmann::json::parse(said({"verify", folder_, "--best", "2", "--json"}));
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0], of_run) << "the same every time";
  EXPECT_EQ(shown().at("best").at("verification"), of_run);
  EXPECT_THAT(said({"verify", folder_}),
              naming("individual " + json[0].at("individual").dump() + ": distance", "  quarter-step "));
  const std::string mark = of_run.at("marks").empty() ? "verified" : of_run.at("marks")[0].get<std::string>();
  EXPECT_THAT(show(), HasSubstr(", " + mark));
}

TEST_F(Command, SignalMeasuresAnExperimentAndARunWhichKeepsTheNumbers) {
  const auto of = [](const Json& json, const std::string& population) {
    return std::ranges::count_if(json.at("numbers"),
                                 [&](const Json& one) { return one.at("population") == population; });
  };
  const std::string bare = said({"signal", file_, "--robots", "12", "--device", "cpu", "--quiet"});
  EXPECT_THAT(bare, naming("repeatability", "heritability", "95 % interval", "all children", "equal bodies"));
  EXPECT_EQ(bare, said({"signal", file_, "--robots", "12", "--device", "cpu", "--threads", "1", "--quiet"}));

  run({"experiment.population=10"});
  EXPECT_TRUE(shown().at("signal").is_null());
  EXPECT_THAT(show(), Not(HasSubstr("repeatability")));
  const std::string chart = scratch_ / "chart.svg";
  const auto measured = Json::parse(said({"signal", folder_, "--robots", "12", "--svg", chart, "--json", "--quiet"}));
  EXPECT_EQ(measured, shown().at("signal"));
  EXPECT_THAT(show(), naming("repeatability", "heritability", "The best robot"));
  for (const char* population : {"random", "last", "champion"}) EXPECT_GE(of(measured, population), 3) << population;
  EXPECT_EQ(measured.at("unit"), "body lengths");
  for (const Json& one : measured.at("numbers"))
    if (one.at("of") == "record") {
      EXPECT_EQ(one.at("value"), shown().at("best").at("objectives").at("distance"));
    }
  EXPECT_THAT(content_of(chart), naming("<svg", "random population", "last population", "body lengths", "</svg>"));

  EXPECT_THAT(refusal({"signal", folder_, "--set", "experiment.lives=2"}), naming("--set", folder_, "is a run"));
  EXPECT_THAT(refusal({"signal", folder_, "--seed", "2"}), naming("--seed", folder_));
  EXPECT_THAT(refusal({"signal", file_, "--robots", "7"}), naming("--robots 7", "8 to 1000"));
  EXPECT_THAT(refusal({"signal", file_, "--svg", file_}), naming("--svg", file_));
  EXPECT_THAT(refusal({"signal", scratch_ / "none"}), naming("none"));
}

TEST_F(Command, AllErrorsOfAnExperimentAreToldWithTheirNumberAndLeaveNothing) {
  std::string text = small_experiment;
  text.replace(text.find("seed = 7"), 8, "seed = -7");
  text.replace(text.find("edge"), 4, "egde");
  const std::string bad = scratch_.write("bad.toml", text);
  for (const Words& command : {Words{"run", bad, "--out", folder_}, {"check", bad}}) {
    std::istringstream lines(refusal(joined(command, {"--threads", "-1"})));
    std::vector<std::string> told;
    for (std::string line; std::getline(lines, line);) told.push_back(line);
    EXPECT_THAT(told, ::testing::ElementsAre(at_place("evodevo: --threads -1: simulation.threads = -1: ", "0 to 4096"),
                                             at_place("evodevo: " + bad + ":3:8: experiment.seed = -7: "),
                                             at_place("evodevo: " + bad + ":11:1: encoding.egde: ", " edge,"),
                                             "evodevo: 3 errors"));
  }
  EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(Command, UsageErrorsAndDevicesThatAreNone) {
  EXPECT_THAT(refusal({"run", file_, "--device", "gpu"}),
              naming("--device gpu: simulation.device = \"gpu\": ", "auto, cpu, cuda"));
  for (const char* device : {"cuda:", "cuda:0,", "cuda:0,0", "cuda:-1", "cuda:x", "cuda:1 ", "cuda:99999999999"})
    EXPECT_THAT(refusal({"check", file_, "--device", device}), naming("--device cuda:", "numbers", "cuda:0,2"));
  EXPECT_THAT(said({"check", file_, "--device", "cuda:0,2"}), ::testing::EndsWith(file_ + ": ok\n")) << "without a GPU";
  EXPECT_THAT(refusal({"rum"}), naming("\"rum\"", "did you mean \"run\"?"));
  EXPECT_THAT(refusal({"run"}), naming("EXPERIMENT.toml", "missing", "usage: evodevo run EXPERIMENT.toml"));
  EXPECT_THAT(refusal({"conform"}), naming("LIBRARY", "missing", "usage: evodevo conform LIBRARY"));
  EXPECT_THAT(refusal({"run", file_, "--sead", "3"}), naming("--sead", "did you mean \"--seed\"?"));
  EXPECT_THAT(refusal({"show", "runs/small-1", "--individual", "best"}),
              naming("'best'", "--individual ID: show this individual"));
  EXPECT_THAT(refusal({"check", file_, "--set", "simulation.dt=0.0003"}),
              naming("development.cycle_time", "the nearest one is 0.0501 s", "simulation.dt"));
  EXPECT_THAT(refusal({"run", file_, "--set", "seed"}), naming("--set seed", "key=value"));
}

TEST_F(Command, CheckTellsTheTopSpeedInEachScene) {
  const auto told = [&](const Words& values) { return said(joined({"check", file_}, setting(values))); };
  // robots of one or two voxels of 0.5 m
  EXPECT_THAT(told({"scene.damping.rate=8", "fitness.0.window=0.2"}),
              naming("top speed: ", "0.6131 m/s", "0.6131 to 1.226 body lengths",
                     " 0.1226 to 0.2453 in the window of 0.2 s", " 0.5 to 1 m long"));
  EXPECT_THAT(told({"scene.damping.rate=8", "scene.gravity.slope=-10"}),
              naming("top speed: ", "0.8167 m/s downhill", "0.3909 m/s uphill", ": downhill 0.8167 to "));
  EXPECT_THAT(told({"scene.gravity.slope=30"}), naming("0.4554 m/s downhill", "nothing uphill"));
  EXPECT_THAT(told({"scene.damping.rate=0"}), naming("top speed: ", "no damping", "muscles"));
  EXPECT_EQ(told({"scene.floor.roughness=0.001"}), file_ + ": ok\n");
  file_ = scratch_.write("scenarios.toml", small_experiment + R"(
[[scenario]]
name = "icy"
friction = { coefficient = 0 }
[[scenario]]
name = "rubber"
friction = { coefficient = 0.9 }
)");
  EXPECT_THAT(told({}), at_place("top speed in scenario rubber: ", "0.4392 m/s", file_ + ": ok\n"));
  EXPECT_THAT(told({}), Not(HasSubstr("icy")));
}

TEST_F(Command, OperatorsDescribeThemselves) {
  const auto json = nlohmann::json::parse(said({"operators", "--kind", "devo", "--json"}));
  ASSERT_EQ(json.size(), 10u);
  EXPECT_EQ(json[8].at("name"), "spring-turnover") << "in alphabetical order";
  EXPECT_EQ(json[8].at("parameters")[0].at("default"), "125");
  for (const auto& described : json)
    for (const auto& parameter : described.at("parameters"))
      EXPECT_NE(parameter.at("unit"), "") << "what has no unit has the unit 1: " << parameter;
  EXPECT_THAT(said({"describe", "spring-turnover"}), HasSubstr("springs = 125"));
  EXPECT_THAT(refusal({"describe", "spring-turnove"}),
              naming("\"spring-turnove\"", "did you mean \"spring-turnover\"?"));
  EXPECT_THAT(refusal({"operators", "--kind", "devos"}), naming("--kind devos: ", "did you mean \"devo\"?"));
  for (const std::string whole : {"--markdown", "--failed"})
    EXPECT_THAT(refusal({"operators", whole, "--kind", "devo"}), naming("--kind devo", whole, "leave one"));
  refusal({"operators", "--markdown", "--json"});
}

class ScenarioRun : public ::testing::Test {
 protected:
  const std::string text_ = small_experiment + R"(
[[fitness]]
name = "descriptor"
what = "contact"
label = "touching"
settle = 0.05
window = 0.1

[[scenario]]
name = "flat"

[[scenario]]
name = "hurt"
damage = 0.1
repeat = 2
[scenario.gravity]
slope = 5
)";

  Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", text_);
  std::string folder_ = (scratch_ / "run").string();
};

TEST_F(Command, NamesLivesByTheirNumber) {
  said({"run", file_, "--out", folder_, "--device", "cpu", "--set", "experiment.lives=3", "--set",
        "experiment.birth_noise=0.01", "--set", "development.draws_between_lives=new"});
  const Archive archive = Archive::read(folder_);
  const std::uint32_t best = archive.best(1).at(0);
  const ArchivedIndividual individual = archive.known_individual(best);
  EXPECT_THAT(said({"show", folder_, "--individual", std::to_string(best)}), naming("distance by life: "));
  const auto shown = nlohmann::json::parse(said({"show", folder_, "--individual", std::to_string(best), "--json"}));
  ASSERT_EQ(shown.at("lives").size(), 3u);
  std::set<std::string> edits, bodies;
  for (const int life : {1, 2, 3}) {
    const std::string number = std::to_string(life);
    EXPECT_EQ(shown["lives"][life - 1]["distance"], individual.result.lives.at(life - 1).at(0));
    const auto told = nlohmann::json::parse(said({"life", folder_, "--json", "--life", number}));
    EXPECT_EQ(told.at("life"), life);
    edits.insert(told.at("edits").dump());
    bodies.insert(said({"body", folder_, "--matured", "--life", number}));
    const auto verified = nlohmann::json::parse(said({"verify", folder_, "--best", "1", "--life", number, "--json"}));
    EXPECT_EQ(verified[0]["fitness"], individual.result.lives[life - 1][0]);
    EXPECT_EQ(verified[0]["trials"][0]["value"], individual.result.lives[life - 1][0]) << "again";
  }
  EXPECT_EQ(edits.size(), 3u);
  EXPECT_EQ(bodies.size(), 3u);
  EXPECT_EQ(said({"body", folder_, "--matured"}), said({"body", folder_, "--matured", "--life", "1"}));
  EXPECT_THAT(said({"life", folder_, "--life", "2"}), naming("in life 2"));
  EXPECT_EQ(Archive::read(folder_).verification(best)->fitness, individual.result.objectives[0])
      << "that of the run is still there";
  for (const Words& command :
       {Words{"life", folder_}, Words{"body", folder_, "--matured"}, Words{"film", folder_}, Words{"verify", folder_}})
    EXPECT_THAT(output_of(program(joined(command, {"--life", "4"})), 2), naming("--life 4", "3 lives", "1 to 3"));
  EXPECT_THAT(output_of(program({"body", folder_, "--life", "2"}), 2), naming("--life", "--matured"));
}

TEST_F(ScenarioRun, KeepsShowsAndVerifiesTheScoresOfEveryTest) {
  said({"run", file_, "--out", folder_, "--device", "cpu", "--set", "fitness.0.over=worst"});
  const Archive archive = Archive::read(folder_);
  const std::uint32_t best = archive.best(1).at(0);
  const std::vector<ArchivedTest> tests = archive.tests(best);
  ASSERT_EQ(tests.size(), 3u * 2) << "two objectives in each of three tests";
  double worst = tests[0].value, work = 0;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    EXPECT_EQ(tests[i].scenario, i < 2 ? "flat" : "hurt");
    EXPECT_EQ(tests[i].repeat, i / 2 == 2 ? 1 : 0);
    EXPECT_EQ(tests[i].objective, i % 2 == 0 ? "distance" : "actuation-work");
    if (i % 2 == 0)
      worst = std::min(worst, tests[i].value);
    else
      work += tests[i].value / 3;
  }
  const ArchivedIndividual individual = archive.known_individual(best);
  EXPECT_EQ(individual.result.objectives.at(0), worst);
  EXPECT_NEAR(individual.result.objectives.at(1), work, 1e-12 * work) << "the mean by default";
  const std::vector<ArchivedMeasure> measures = archive.measures(best);
  ASSERT_EQ(measures.size(), 1u);
  EXPECT_EQ(measures[0].name, "touching");
  EXPECT_EQ(measures[0].role, "descriptor");

  const std::string text = said({"show", folder_});
  EXPECT_THAT(text, naming("distance by scenario: flat ", ", hurt ", "actuation-work by scenario: flat ",
                           "actuation-work (J), lower is better", "best individuals in actuation-work"));
  EXPECT_THAT(text, ::testing::ContainsRegex("touching [0-9.e-]+\n"));  // no unit "1"
  const Json shown = Json::parse(said({"show", folder_, "--json"})).at("best");
  ASSERT_EQ(shown.at("scenarios").size(), 3u);
  EXPECT_EQ(shown.at("scenarios")[2].at("scenario"), "hurt");
  EXPECT_EQ(shown.at("scenarios")[2].at("repeat"), 2);
  EXPECT_EQ(shown.at("scenarios")[2].at("objectives").size(), 2u);
  EXPECT_GT(shown.at("measures").at("touching"), 0);

  const Json verification = Json::parse(said({"verify", folder_, "--best", "1", "--json"})).at(0);
  EXPECT_EQ(verification.at("trials")[0].at("trial"), "again");
  EXPECT_EQ(verification.at("trials")[0].at("value"), verification.at("fitness")) << "the worst of all tests, again";

  const std::string body = scratch_.write("body.json", said({"body", folder_}));
  const Words simulate{"simulate", body, file_, "--duration", "0.2", "--device", "cpu"};
  const auto end = [&](const Words& more) {
    const std::string output = said(joined(simulate, more));
    return output.substr(output.find("after"), output.find("speed") - output.find("after"));
  };
  EXPECT_EQ(end({}), end({"--scenario", "flat"}));
  EXPECT_NE(end({}), end({"--scenario", "hurt"}));
  EXPECT_THAT(refusal(joined(simulate, {"--scenario", "flatt"})), naming("--scenario flatt", "flat, hurt"));
}

TEST_F(ScenarioRun, TellsALifeInAScenarioThatDevelops) {
  const std::string mud = scratch_.write(
      "mud.toml", text_ + "\n[[scenario]]\nname = 'mud'\ndevelops = true\n[scenario.drag]\ncoefficient = 3\n");
  said({"run", mud, "--out", folder_, "--device", "cpu"});
  const auto life = [&](const Words& more) { return Json::parse(said(joined({"life", folder_, "--json"}, more))); };
  const Json here = life({}), there = life({"--scenario", "mud"});
  EXPECT_TRUE(here.at("scenario").is_null());
  EXPECT_EQ(there.at("scenario"), "mud");
  EXPECT_EQ(there.at("born"), here.at("born"));
  EXPECT_EQ(there.at("edits").size(), here.at("edits").size()) << "the operators do as much";
  EXPECT_NE(there.at("edits"), here.at("edits")) << "but for other causes";
  EXPECT_NE(said({"body", folder_, "--matured"}), said({"body", folder_, "--matured", "--scenario", "mud"}));
  EXPECT_THAT(refusal({"life", folder_, "--scenario", "hurt"}), naming("--scenario hurt", "develop"));
  EXPECT_THAT(refusal({"body", folder_, "--scenario", "mud"}), naming("--scenario mud", "--matured"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
