#include "experiment/tables/operators.hpp"

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "experiment/tables/declarations.hpp"
#include "experiment/tables/selection.hpp"
#include "operators/host_keys.hpp"

namespace evodevo {

const AvailableOperator& OperatorFactory::named_in(TomlReader& table, std::string_view kind) const {
  const std::string name = table.text(host_key::name);
  const AvailableOperator* available = registry_.find(kind, name);
  if (available == nullptr) {
    const std::vector<std::string> known = registry_.names(kind);
    std::string message = "no " + std::string(kind) + " operator has this name" + suggestion(name, known);
    if (nearest(name, known).empty())
      message += "; give the folder of another operator in [plugins] paths or with --plugin-path";
    if (!registry_faults_.empty()) message += "; " + registry_faults_.front();
    if (registry_faults_.size() > 1)
      message += " (and " + std::to_string(registry_faults_.size() - 1) + " more such warnings)";
    table.fail("name", message);
  }
  const std::string label = table.text(host_key::label, "");
  if (const std::string fault = text_fault(label); !fault.empty()) table.fail(host_key::label, fault);
  experiment_.uses.push_back({available->entry->kind, name, available->manifest->version, available->file,
                              file_hash(available->file), available->title, label});
  return *available;
}

void OperatorFactory::write(const TomlReader& table, Operator& op, TomlWriter& writer) const {
  writer.add(host_key::name, experiment_.uses.back().name);
  if (!experiment_.uses.back().label.empty()) writer.add(host_key::label, experiment_.uses.back().label);
  ask(table, [&] {
    op.parameters(writer);
    return 0;
  });
}

namespace {

/// Reads the tables of operators one after the other.
class OperatorTables {
 public:
  OperatorTables(TomlReader& top, const OperatorFactory& factory, const ExperimentSource& source,
                 Experiment& experiment, toml::table& record)
      : top_(top), factory_(factory), source_(source), out_(experiment), record_(record) {}

  void read() {
    read_encoding();
    read_table(
        top_, "development", false, [&](TomlReader& t) { read_development_operators(t); }, references());
    shared_ = out_.layout;
    read_variation("mutation", out_.mutations, [&](TomlReader& t, Varied<Mutation>& mutation) {
      mutation.own_section = add_own_section(t, [&] { return mutation.op->layout(mutation.layout); });
    });
    read_variation("crossover", out_.crossovers, [](TomlReader&, Varied<Crossover>&) {});
    complete_layouts(out_.mutations);
    complete_layouts(out_.crossovers);
    read_array(top_, "fitness", record_, [&](TomlReader& t, TomlWriter& writer) { read_fitness(t, writer); });
    if (out_.fitness.empty()) top_.fail("fitness", "is missing; add a table [[fitness]]");
    const auto is_within_life = [&](const Scored& scored) { return scored.op->observes().cycle.has_value(); };
    if (!std::ranges::all_of(out_.scenarios, &Scenario::develops) && std::ranges::all_of(out_.fitness, is_within_life))
      top_.fail("scenario",
                "no fitness operator measures robots after they have matured; set develops = true in every scenario, "
                "or add such an operator");
    if (out_.objectives.empty())
      top_.fail("fitness", "no operator has an objective by which individuals could be selected; add one that has");
    read_selection(top_, factory_, references(), out_, record_);
    check_variation();
  }

 private:
  References references() const {
    return {&out_.context.material_names, source_.folder(), source_.files ? &*source_.files : nullptr, &out_.files};
  }

  /// Calls `read` for the table [name], and adds the table to the record.
  template <class Read>
  void read_one(std::string_view name, const Read& read) {
    TomlWriter writer;
    read_table(
        top_, name, true, [&](TomlReader& t) { read(t, writer); }, references());
    record_.insert_or_assign(name, writer.take());
  }

  /// Calls `read` for each table of the array [[name]] in `parent`, and adds these tables to `record`.
  template <class Read>
  void read_array(TomlReader& parent, std::string_view name, toml::table& record, const Read& read) {
    toml::array written;
    const auto tables = parent.tables(name);
    if (tables.size() > rng_stream::most_operators)
      parent.fail(name, "expected at most " + std::to_string(rng_stream::most_operators) + " of these tables");
    for (std::size_t i = 0; i < tables.size(); ++i) {
      TomlReader reader(*tables[i], parent.full_name(name) + "." + std::to_string(i), references());
      TomlWriter writer;
      read(reader, writer);
      reader.finish();
      written.push_back(writer.take());
    }
    if (!tables.empty()) record.insert_or_assign(name, std::move(written));
  }

  void read_encoding() {
    read_one("encoding", [&](TomlReader& t, TomlWriter& writer) {
      declare_mass(t, out_);
      declare_mass(writer, out_);
      out_.encoding = factory_.make<Encoding>(t);
      factory_.write(t, *out_.encoding, writer);
      out_.layout.sections.clear();
      add_own_section(t, [&] { return out_.encoding->layout(out_.context); });
    });
  }

  /// Adds the section that the operator which was made last owns to the layout of whole genomes. `declare` asks for its
  /// layout. Returns the index of the section, or nothing if the operator owns no genes.
  template <class Declare>
  std::optional<std::uint32_t> add_own_section(const TomlReader& t, const Declare& declare) {
    return factory_.ask(t, [&]() -> std::optional<std::uint32_t> {
      Layout layout = declare();
      const bool is_encoding = out_.own_layouts.empty();
      if (layout.types.empty() && !is_encoding) return std::nullopt;
      const std::uint32_t section = add_section(out_.layout, out_.uses.back().own_name(), layout);
      out_.own_layouts.push_back(std::move(layout));
      return section;
    });
  }

  /// Reads on which sections a variation operator works: by default on all but those of mutations.
  SectionIndices read_sections(TomlReader& t, TomlWriter& writer) const {
    const std::vector<std::string> names = t.texts(host_key::sections);
    SectionIndices sections;
    for (const std::string& name : names)
      if (std::find(shared_.sections.begin(), shared_.sections.end(), name) == shared_.sections.end())
        t.fail(host_key::sections, "\"" + printable(name) + "\" is no section of these genomes; expected some of " +
                                       joined(shared_.sections));
    toml::array written;
    for (std::uint32_t i = 0; i < shared_.sections.size(); ++i) {
      const bool is_named = std::find(names.begin(), names.end(), shared_.sections[i]) != names.end();
      if (!is_named && !names.empty()) continue;
      sections.push_back(i);
      if (is_named) written.push_back(shared_.sections[i]);
    }
    if (!names.empty()) writer.add(host_key::sections, std::move(written));
    return sections;
  }

  /// Throws ConfigError if an operator works on types of blocks that its genomes do not have.
  void check_block_types(const TomlReader& t, const Operator& op, const Layout& layout) const {
    for (const std::string& name : factory_.ask(t, [&] { return op.traits(); }).block_types) {
      const auto is_wanted = [&](const BlockType& type) { return type.name == name; };
      if (std::any_of(layout.types.begin(), layout.types.end(), is_wanted)) continue;
      t.fail("name", "this operator works on blocks of the type \"" + printable(name) +
                         "\" (its trait block_types), which no section of " + joined(layout.sections) +
                         " has; take an encoding that has them, or another operator");
    }
  }

  /// Adds the sections that operators own to the layouts on which they work, when all sections are known.
  template <class T>
  void complete_layouts(std::vector<Varied<T>>& list) const {
    for (Varied<T>& varied : list) {
      if (varied.own_section) varied.sections.push_back(*varied.own_section);
      varied.layout = some_sections(out_.layout, varied.sections, varied.own_section);
    }
  }

  /// Reads the operators of a list; `finish` is called for each when it is made.
  template <class T, class Finish>
  void read_variation(std::string_view name, std::vector<Varied<T>>& list, const Finish& finish) {
    read_array(top_, name, record_, [&](TomlReader& t, TomlWriter& writer) {
      Varied<T> varied;
      declare_probability(t, varied.probability);
      declare_probability(writer, varied.probability);
      varied.sections = read_sections(t, writer);
      varied.layout = some_sections(shared_, varied.sections);
      varied.op = factory_.make<T>(t);
      varied.name = out_.uses.back().name;
      factory_.write(t, *varied.op, writer);
      check_block_types(t, *varied.op, varied.layout);
      finish(t, varied);
      list.push_back(std::move(varied));
    });
  }

  void check_variation() const {
    if (out_.makes_children()) return refuse_variation();
    if (out_.mutations.empty() && out_.crossovers.empty())
      top_.fail("mutation", "is missing; add a table [[mutation]] or [[crossover]]");
    double sum = 0;
    for (const auto& mutation : out_.mutations) sum += mutation.probability;
    for (const auto& crossover : out_.crossovers) sum += crossover.probability;
    if (sum == 0)
      top_.fail("mutation",
                "no operator has a probability above 0, so every child would be a clone; give one of them a higher "
                "probability");
  }

  void refuse_variation() const {
    const std::string why = "the selection operator \"" + out_.child_maker +
                            "\" makes the children itself (its trait makes_children); remove the tables of this name, "
                            "or choose another selection operator";
    if (!out_.mutations.empty()) top_.fail("mutation", why);
    if (!out_.crossovers.empty()) top_.fail("crossover", why);
  }

  void read_development_operators(TomlReader& t) {
    declare_development(t, out_);
    toml::table& record = *record_["development"].as_table();
    read_array(t, "operator", record, [&](TomlReader& entry, TomlWriter& writer) { read_devo(entry, writer); });
    if (!out_.devo.empty()) return;
    const std::string remedy = "there is no devo operator; add a table [[development.operator]]";
    if (out_.development.control != Control::off) t.fail("control", remedy + ", or set control = \"off\"");
    if (out_.development.cycles > 0)
      out_.warnings.push_back("development.cycles = " + std::to_string(out_.development.cycles) + ": " + remedy +
                              ", or leave [development] out");
  }

  void read_devo(TomlReader& t, TomlWriter& writer) {
    Schedule schedule = read_schedule(t);
    declare_schedule(writer, schedule);
    out_.devo.push_back({factory_.make<Devo>(t), schedule});
    Devo& op = *out_.devo.back().op;
    factory_.write(t, op, writer);
    out_.devo.back().own_section = add_own_section(t, [&] { return op.layout(out_.context); });
    check_request(t, factory_.ask(t, [&] { return op.observes(); }));
    factory_.ask(t, [&] { return memory_names(op); });
    if (factory_.ask(t, [&] { return op.uses_growth() && !out_.encoding->sets_growth(); }))
      out_.warnings.push_back(t.full_name("name") + " = \"" + out_.uses.back().name +
                              "\": the encoding lets no spring grow, so this operator changes nothing; set "
                              "encoding.size_range, or choose an encoding that has this key");
  }

  /// Reads the schedule of a devo operator; by default the operator is applied after every cycle.
  Schedule read_schedule(TomlReader& t) {
    const std::int64_t cycles = out_.development.cycles;
    Schedule schedule;
    schedule.to = std::max<std::int64_t>(1, cycles);
    declare_schedule(t, schedule);
    if (schedule.applications(cycles) == 0 && cycles > 0)
      out_.warnings.push_back(t.full_name("from") + " = " + std::to_string(schedule.from) + ", to = " +
                              std::to_string(schedule.to) + ": the operator is never applied, because there are " +
                              std::to_string(cycles) + " cycles; correct from or to");
    return schedule;
  }

  /// Throws ConfigError if an operator asks for more than stress and the probe is skip-shift, whose tallies only
  /// estimate stress.
  void check_request(const TomlReader& t, const RecordRequest& request) const {
    if (out_.development.probe == Probe::skip_shift && (request.peak_force || request.muscle_work || request.tension))
      t.fail("name",
             "this operator needs measurements of springs that development.probe = \"skip-shift\" does not make; set "
             "development.probe = \"exact\", or let the operator use the mean force alone");
  }

  void read_fitness(TomlReader& t, TomlWriter& writer) {
    Scored scored{factory_.make<Fitness>(t)};
    const Fitness& fitness = *scored.op;
    factory_.write(t, *scored.op, writer);
    read_over(t, writer, scored);
    const Request request = factory_.ask(t, [&] { return fitness.observes(); });
    check_request(t, request);
    if (scored.scenario && request.cycle && !out_.scenarios[*scored.scenario].develops)
      t.fail(host_key::over,
             "the operator measures robots while they develop, which they do not do in this scenario; "
             "set develops = true there, or choose another scenario");
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
      if (is_objective) add_cases(request.cycle.has_value());
    }
    out_.fitness.push_back(std::move(scored));
  }

  /// Throws ConfigError if the front cannot be verified: the first objective is measured within the life, or minimised.
  void check_front(const TomlReader& t, const Objective& objective, const Request& request) const {
    if (!out_.verify_front || !out_.objectives.empty() || (!request.cycle && objective.maximise)) return;
    t.fail("name",
           "the experiment has verify_front = true, and the first objective, \"" + printable(objective.name) +
               (request.cycle ? "\", is measured within the life, which verification does not repeat; put an "
                                "operator that measures after maturing"
                              : "\", is minimised, so that half of it is no measure; put one that is maximised") +
               " first, or remove verify_front from [experiment]");
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
      t.fail(host_key::over,
             "expected \"mean\", \"worst\", \"median\" or the name of a scenario" + suggestion(over, names));
    if (place < names_of<Over>.size())
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

  /// Throws ConfigError if the settling time or the window of a fitness operator is out of range.
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

  /// Throws ConfigError if a fitness operator asks for more samples than a body can be sampled.
  static void check_samples(const TomlReader& t, const Request& request) {
    constexpr double most = 1e6;
    if (!(request.rate >= 0) || !(request.rate * request.window <= most))
      t.fail("name", "this operator asks for " + to_text(request.rate) + " samples per second for " +
                         to_text(request.window) + " s; expected a rate of at least 0, and at most " + to_text(most) +
                         " samples");
    if (request.channels.any() && request.rate == 0)
      t.fail("name", "this operator asks for channels of samples, but for no samples; it must set Request::rate");
  }

  /// Throws ConfigError if a window within the life does not lie within the life.
  void check_window_within_life(const TomlReader& t, const Request& request) const {
    const DevelopmentSettings& development = out_.development;
    const double ends = static_cast<double>(development.cycles) * development.cycle_time;
    if (*request.cycle < 0 || *request.cycle >= development.cycles)
      t.fail("name", "this operator measures from cycle " + std::to_string(*request.cycle) + " of development on; " +
                         (development.cycles == 0 ? "bodies do not develop: add a table [development]"
                                                  : "expected 0 to " + std::to_string(development.cycles - 1)));
    const double closes =
        static_cast<double>(*request.cycle) * development.cycle_time + request.settle + request.window;
    if (!(closes <= ends + 1e-9))
      t.fail("name", "this operator measures until " + to_text(closes) + " s of the life, which ends after " +
                         to_text(ends) + " s; shorten its window, or add cycles");
  }

  void add_objective(const TomlReader& t, Objective objective) {
    if (objective.name.empty())
      t.fail("name", "this operator has an objective without a name; name it in objectives()");
    for (const std::string& text : {objective.name, objective.unit})
      if (const std::string fault = text_fault(text); !fault.empty())
        t.fail("name", "its objective's name or unit " + fault);
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
  const ExperimentSource& source_;
  Experiment& out_;
  toml::table& record_;
  Layout shared_;  ///< of all sections but those of mutations
};

}  // namespace

void read_operators(TomlReader& top, const OperatorFactory& factory, const ExperimentSource& source,
                    Experiment& experiment, toml::table& record) {
  OperatorTables(top, factory, source, experiment, record).read();
}

}  // namespace evodevo
