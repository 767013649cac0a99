#include "experiment/tables/operators.hpp"

#include <algorithm>

#include "base/text.hpp"
#include "experiment/tables/declarations.hpp"
#include "experiment/tables/fitness.hpp"
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
    table.fail("name", message, {"plugins"});
  }
  const std::string label = table.text(host_key::label, "");
  if (const std::string fault = text_fault(label); !fault.empty()) table.report(host_key::label, fault);
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
    read_fitness(top_, factory_, references(), out_, record_);
    read_selection(top_, factory_, references(), out_, record_);
    check_variation();
  }

 private:
  References references() const {
    return {&out_.context.material_names, source_.folder(), source_.files ? &*source_.files : nullptr, &out_.files};
  }

  /// Calls `read` for the table [name] of an operator, and adds the table to the record.
  template <class Read>
  void read_operator(std::string_view name, const Read& read) {
    TomlWriter writer;
    visit_table(
        top_, name, true, [&](TomlReader& t) { read(t, writer); }, references());
    record_.insert_or_assign(name, writer.take());
  }

  void read_encoding() {
    read_operator("encoding", [&](TomlReader& t, TomlWriter& writer) {
      declare_mass(t, out_);
      declare_mass(writer, out_);
      std::unique_ptr<Encoding> encoding = factory_.make<Encoding>(t);
      factory_.write(t, *encoding, writer);
      out_.layout.sections.clear();
      add_own_section(t, [&] { return encoding->layout(out_.context); });
      out_.encoding = std::move(encoding);
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
        t.report(
            host_key::sections,
            "\"" + printable(name) + "\" is no section of these genomes; expected some of " + joined(shared_.sections),
            {"encoding", "development"});
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

  /// Reports if an operator works on types of blocks that its genomes do not have.
  void check_block_types(const TomlReader& t, const Operator& op, const Layout& layout) const {
    for (const std::string& name : factory_.ask(t, [&] { return op.traits(); }).block_types) {
      const auto is_wanted = [&](const BlockType& type) { return type.name == name; };
      if (std::any_of(layout.types.begin(), layout.types.end(), is_wanted)) continue;
      t.report("name",
               "this operator works on blocks of the type \"" + printable(name) +
                   "\" (its trait block_types), which no section of " + joined(layout.sections) +
                   " has; take an encoding that has them, or another operator",
               {"encoding", "development"});
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
    read_operator_list(top_, name, references(), record_, [&](TomlReader& t, TomlWriter& writer) {
      Varied<T> varied;
      declare_probability(t, varied.probability);
      declare_probability(writer, varied.probability);
      varied.sections = read_sections(t, writer);
      varied.layout = some_sections(shared_, varied.sections);
      varied.op = factory_.make<T>(t);
      varied.name = out_.uses.back().name;
      factory_.write(t, *varied.op, writer);
      if (out_.encoding) {  // otherwise the genomes are not known
        check_block_types(t, *varied.op, varied.layout);
        finish(t, varied);
      }
      list.push_back(std::move(varied));
    });
  }

  void check_variation() const {
    if (out_.makes_children()) return refuse_variation();
    // an operator that could not be made might have made the children itself
    const std::vector<std::string> all{"mutation", "crossover", out_.selection ? "selection.parents" : "selection"};
    if (out_.mutations.empty() && out_.crossovers.empty())
      return top_.report("mutation", "is missing; add a table [[mutation]] or [[crossover]]", all);
    double sum = 0;
    for (const auto& mutation : out_.mutations) sum += mutation.probability;
    for (const auto& crossover : out_.crossovers) sum += crossover.probability;
    if (sum == 0)
      top_.report("mutation",
                  "no operator has a probability above 0, so every child would be a clone; give one of them a higher "
                  "probability",
                  all);
  }

  void refuse_variation() const {
    const std::string why = "the selection operator \"" + out_.child_maker +
                            "\" makes the children itself (it overrides children()); remove the tables of this name, "
                            "or choose another selection operator";
    if (!out_.mutations.empty()) top_.report("mutation", why);
    if (!out_.crossovers.empty()) top_.report("crossover", why);
  }

  void read_development_operators(TomlReader& t) {
    declare_development(t, out_);
    toml::table& record = *record_["development"].as_table();
    read_operator_list(t, "operator", references(), record,
                       [&](TomlReader& entry, TomlWriter& writer) { read_devo(entry, writer); });
    if (!out_.devo.empty()) return;
    const std::string remedy = "there is no devo operator; add a table [[development.operator]]";
    if (out_.development.control != Control::off)
      return t.report("control", remedy + ", or set control = \"off\"", {"development"});
    if (out_.development.cycles > 0)
      out_.warnings.push_back("development.cycles = " + std::to_string(out_.development.cycles) + ": " + remedy +
                              ", or leave [development] out");
  }

  void read_devo(TomlReader& t, TomlWriter& writer) {
    Schedule schedule = read_schedule(t);
    declare_schedule(writer, schedule);
    out_.devo.push_back({factory_.make<Devo>(t), {}, schedule});
    const std::string& name = out_.uses.back().own_name();
    const auto same = std::ranges::count_if(
        out_.uses, [&](const OperatorUse& use) { return use.kind == Devo::kind && use.own_name() == name; });
    out_.devo.back().label = same == 1 ? name : name + " " + std::to_string(same);
    Devo& op = *out_.devo.back().op;
    factory_.write(t, op, writer);
    out_.devo.back().own_section = add_own_section(t, [&] { return op.layout(out_.context); });
    check_request(t, factory_.ask(t, [&] { return op.observes(); }));
    factory_.ask(t, [&] { return memory_names(op); });
    const std::vector<std::string> needed = factory_.ask(t, [&] { return op.traits().needs_at_birth; });
    const std::vector<std::string> given =
        out_.encoding ? factory_.ask(t, [&] { return spring_memory_names(*out_.encoding); }) : needed;
    for (const std::string& what : needed)
      if (std::ranges::find(given, what) == given.end())
        out_.warnings.push_back(t.full_name("name") + " = \"" + out_.uses.back().name +
                                "\": the encoding gives springs no \"" + printable(what) +
                                "\", so this operator changes nothing; set the parameter of [encoding] that does "
                                "(\"evodevo describe\" tells which), or choose another encoding");
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

  /// Reports if an operator asks for more than stress and the probe is skip-shift, whose tallies only estimate stress.
  void check_request(const TomlReader& t, const RecordRequest& request) const {
    if (out_.development.probe == Probe::skip_shift && (request.peak_force || request.muscle_work || request.tension))
      t.report("name",
               "this operator needs measurements of springs that development.probe = \"skip-shift\" does not make; set "
               "development.probe = \"exact\", or let the operator use the mean force alone",
               {"development"});
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
