#include "experiment/tables/fitness.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/tables/declarations.hpp"

namespace evodevo {
namespace {

class FitnessTables {
 public:
  FitnessTables(TomlReader& top, const OperatorFactory& factory, Experiment& experiment)
      : top_(top), factory_(factory), out_(experiment) {}

  void read(const References& references, toml::table& record) {
    read_operator_list(top_, "fitness", references, record,
                       [&](TomlReader& t, TomlWriter& writer) { read_one(t, writer); });
    check_scores();
  }

 private:
  /// Reports if the scores of the fitness operators do not suffice.
  void check_scores() const {
    if (out_.fitness.empty()) top_.report("fitness", "is missing; add a table [[fitness]]", {"fitness"});
    const auto is_within_life = [&](const Scored& scored) { return scored.op->observes().cycle.has_value(); };
    if (!std::ranges::all_of(out_.scenarios, &Scenario::develops) && std::ranges::all_of(out_.fitness, is_within_life))
      top_.report("scenario",
                  "no fitness operator measures robots after they have matured; set develops = true in every scenario, "
                  "or add such an operator",
                  {"scenario", "fitness"});
    if (out_.objectives.empty())
      top_.report("fitness", "no operator has an objective by which individuals could be selected; add one that has",
                  {"fitness"});
  }

  void read_one(TomlReader& t, TomlWriter& writer) {
    Scored scored;
    read_over(t, writer, scored);
    Over over_lives = Over::mean;
    declare_over_lives(t, over_lives);
    declare_over_lives(writer, over_lives);
    scored.op = factory_.make<Fitness>(t);
    const Fitness& fitness = *scored.op;
    factory_.write(t, *scored.op, writer);
    const Request request = factory_.ask(t, [&] { return fitness.observes(); });
    check_request(t, request);
    if (scored.scenario && request.cycle && !out_.scenarios[*scored.scenario].develops)
      t.report(host_key::over,
               "the operator measures robots while they develop, which they do not do in this scenario; "
               "set develops = true there, or choose another scenario",
               {"scenario"});
    check_duration(t, "settle", request.settle, out_.step);
    check_duration(t, "window", request.window, out_.step);
    std::vector<Objective> objectives = factory_.ask(t, [&] { return fitness.objectives(); });
    if (objectives.empty()) t.fail("name", "this operator gives no scores; expected one or more from objectives()");
    const std::string& label = out_.uses.back().label;
    for (Objective& objective : objectives) {
      if (!label.empty()) objective.name = objectives.size() == 1 ? label : label + "-" + objective.name;
      const bool is_objective = objective.role == Role::objective;
      if (is_objective) check_front(t, objective, request);
      add_objective(t, std::move(objective));
      if (is_objective) out_.over_lives.push_back(over_lives);
      if (is_objective) add_cases(request.cycle.has_value());
    }
    out_.fitness.push_back(std::move(scored));
  }

  /// Reports if the front cannot be verified: the first objective is measured within the life, or minimised.
  void check_front(const TomlReader& t, const Objective& objective, const Request& request) const {
    if (out_.verify_front == VerifyFront::off || !out_.objectives.empty() || (!request.cycle && objective.maximise))
      return;
    t.report("name",
             "the experiment has verify_front = \"" + std::string(name_of(out_.verify_front)) +
                 "\", and the first objective, \"" + printable(objective.name) +
                 (request.cycle ? "\", is measured within the life, which verification does not repeat; put an "
                                  "operator that measures after maturing"
                                : "\", is minimised, so that half of it is no measure; put one that is maximised") +
                 " first, or remove verify_front from [experiment]",
             {"fitness"});
  }

  /// Reads how the scores of a fitness operator in several tests become one.
  void read_over(TomlReader& t, TomlWriter& writer, Scored& scored) const {
    std::string over(name_of(scored.over));
    declare_over(t, over);
    declare_over(writer, over);
    std::vector<std::string> names(names_of<Over>.begin(), names_of<Over>.end());
    for (const Scenario& scenario : out_.scenarios) names.push_back(scenario.name);
    const auto place = static_cast<std::size_t>(std::find(names.begin(), names.end(), over) - names.begin());
    if (place == names.size())
      t.report(host_key::over,
               "expected \"mean\", \"worst\", \"median\" or the name of a scenario" + suggestion(over, names),
               {"scenario"});
    else if (place < names_of<Over>.size())
      scored.over = static_cast<Over>(place);
    else
      scored.scenario = place - names_of<Over>.size();
  }

  /// Adds the cases of the objective that was read last. A window within the life is scored in the scenarios in which
  /// robots develop.
  void add_cases(bool is_within_life) {
    const auto objective = static_cast<std::uint32_t>(out_.objectives.size() - 1);
    const std::size_t before = out_.cases.size();
    for (const Scenario& scenario : out_.scenarios)
      for (std::uint32_t repeat = 0; repeat < scenario.repeat && (scenario.develops || !is_within_life); ++repeat)
        out_.cases.push_back({objective, scenario.name, repeat});
    if (out_.cases.size() == before) out_.cases.push_back({objective});
  }

  /// Throws KeyError if the settling time or the window of a fitness operator is out of range. Reports if a window
  /// within the life does not lie within it.
  void check_request(const TomlReader& t, const Request& request) const {
    constexpr double longest = 1e6;  // s, the same limit as for the time of a cycle
    const auto text = [](double time) { return std::isfinite(time) ? to_text(time) + " s" : "no finite number"; };
    // written so that NaN fails
    if (!(request.settle >= 0 && request.settle <= longest) || !(request.window > 0 && request.window <= longest))
      t.fail("name", "this operator observes settle = " + text(request.settle) +
                         " and window = " + text(request.window) + "; expected settle from 0 to " + text(longest) +
                         ", and window above 0 and at most " + text(longest));
    check_samples(t, request);
    if (request.cycle) check_window_within_life(t, request);
  }

  /// Throws KeyError if a fitness operator asks for more samples than a body can be sampled.
  static void check_samples(const TomlReader& t, const Request& request) {
    constexpr double most = 1e6;
    if (!(request.rate >= 0) || !(request.rate * request.window <= most))
      t.fail("name", "this operator asks for " + to_text(request.rate) + " samples per second for " +
                         to_text(request.window) + " s; expected a rate of at least 0, and at most " + to_text(most) +
                         " samples");
    if (request.channels.any() && request.rate == 0)
      t.fail("name", "this operator asks for channels of samples, but for no samples; it must set Request::rate");
  }

  /// Reports if a window within the life does not lie within the life.
  void check_window_within_life(const TomlReader& t, const Request& request) const {
    const DevelopmentSettings& development = out_.development;
    const double ends = static_cast<double>(development.cycles) * development.cycle_time;
    if (*request.cycle < 0 || *request.cycle >= development.cycles)
      return t.report("name",
                      "this operator measures from cycle " + std::to_string(*request.cycle) + " of development on; " +
                          (development.cycles == 0 ? "bodies do not develop: add a table [development]"
                                                   : "expected 0 to " + std::to_string(development.cycles - 1)),
                      {"development"});
    const double closes =
        static_cast<double>(*request.cycle) * development.cycle_time + request.settle + request.window;
    if (!(closes <= ends + 1e-9))
      t.report("name",
               "this operator measures until " + to_text(closes) + " s of the life, which ends after " + to_text(ends) +
                   " s; shorten its window, or add cycles",
               {"development"});
  }

  void add_objective(const TomlReader& t, Objective objective) {
    if (objective.name.empty())
      t.fail("name", "this operator has an objective without a name; name it in objectives()");
    for (const std::string& text : {objective.name, objective.unit})
      if (const std::string fault = text_fault(text); !fault.empty())
        t.fail("name", "its objective's name or unit " + fault);
    if (objective.role > Role::measure)
      t.fail("name", "its score \"" + objective.name + "\" has the role " +
                         std::to_string(static_cast<int>(objective.role)) +
                         ", which this evodevo does not know; give it one of evodevo::Role");
    if (objective.role == Role::descriptor &&
        !(objective.low < objective.high && std::isfinite(objective.low) && std::isfinite(objective.high)))
      t.fail("name", "its descriptor \"" + objective.name + "\" has the range " + to_text(objective.low) + " to " +
                         to_text(objective.high) + "; expected two numbers, the smaller first");
    if (objective.bins < 1 || objective.bins > Objective::most_bins)
      t.fail("name", "its descriptor \"" + objective.name + "\" has bins = " + std::to_string(objective.bins) +
                         "; expected 1 to " + std::to_string(Objective::most_bins));
    const auto same = [&](const Objective& other) { return other.name == objective.name; };
    for (const auto* scores : {&out_.objectives, &out_.measures})
      if (std::any_of(scores->begin(), scores->end(), same))
        t.fail("name", "there is already a score \"" + objective.name +
                           "\"; remove one of the two operators, or tell them apart by a label");
    (objective.role == Role::objective ? out_.objectives : out_.measures).push_back(std::move(objective));
  }

  TomlReader& top_;
  const OperatorFactory& factory_;
  Experiment& out_;
};

}  // namespace

void read_fitness(TomlReader& top, const OperatorFactory& factory, const References& references, Experiment& experiment,
                  toml::table& record) {
  FitnessTables(top, factory, experiment).read(references, record);
}

}  // namespace evodevo
