#include "experiment/tables/selection.hpp"

#include <algorithm>

namespace evodevo {
namespace {

/// What an operator is to choose.
struct Choice {
  bool parents = true, survivors = true;
};

/// Returns the name of the first type of blocks that is not an array of real genes of the same length in all genomes,
/// or an empty text if there is none.
std::string unreal_type(const Layout& layout) {
  const auto is_real = [](const GeneSpec& gene) { return gene.is_real(); };
  for (const BlockType& type : layout.types)
    if (!type.is_fixed() || !std::all_of(type.genes.begin(), type.genes.end(), is_real))
      return "\"" + printable(type.name) + "\" of " + printable(layout.sections[type.section]);
  return "";
}

/// Throws KeyError if an operator does not choose what it is to choose. `remembers` tells whether it declares a memory.
void check_choice(const TomlReader& t, const Overrides& has, bool remembers, const Choice& choice) {
  if (choice.survivors && !has.survivors)
    t.fail("name",
           "this operator chooses no survivors (it overrides no survivors()); name it in [selection.parents], and "
           "another one in [selection.survivors]");
  if (choice.parents && !has.parents && !has.children)
    t.fail("name",
           "this operator chooses no parents (it overrides neither parents() nor children()); name it in "
           "[selection.survivors], and another one in [selection.parents]");
  if (!choice.survivors && has.survivors && remembers)
    t.fail("name",
           "this operator remembers something when it chooses the survivors (its memory()), which another one would "
           "do here; name it in [selection] for both, or another one in [selection.parents]");
}

/// Reports if an operator needs a larger population, or more children, than a generation has.
void check_sizes(const TomlReader& t, const Traits& traits, const Experiment& experiment) {
  const auto check = [&](std::int64_t needed, std::int64_t given, const std::string& key, const std::string& trait) {
    if (given < needed)
      t.report("name",
               "this operator needs " + key + " = " + std::to_string(needed) + " or more (its trait " + trait +
                   "), and the experiment has " + std::to_string(given) + "; raise " + key +
                   " in [experiment], or choose another operator",
               {"experiment"});
  };
  check(traits.least_population, experiment.population, "population", "least_population");
  check(traits.least_children, experiment.newborns(), experiment.children > 0 ? "children" : "population",
        "least_children");
}

/// Reports if fewer scores than an operator needs have a role.
void check_scores(const TomlReader& t, std::size_t needed, std::size_t given, const std::string& role) {
  if (given < needed)
    t.report("name",
             "this operator needs " + std::to_string(needed) + " " + role +
                 "s or more, and the fitness operators give " + std::to_string(given) +
                 "; add a table [[fitness]] with an operator that gives one, or choose another operator",
             {"fitness"});
}

/// Reports what else keeps an operator from working in the experiment.
void check_traits(const TomlReader& t, const Traits& traits, const Experiment& experiment) {
  check_sizes(t, traits, experiment);
  check_scores(t, traits.least_objectives, experiment.objectives.size(), name(Role::objective));
  const auto descriptors = std::count_if(experiment.measures.begin(), experiment.measures.end(),
                                         [](const Objective& measure) { return measure.role == Role::descriptor; });
  check_scores(t, traits.least_descriptors, static_cast<std::size_t>(descriptors), name(Role::descriptor));
  if (const std::string type = unreal_type(experiment.layout); traits.needs_real_genes && !type.empty())
    t.report("name",
             "this operator works on real genes alone, whose number is the same in all genomes (its trait "
             "needs_real_genes), and the blocks " +
                 type + " are not such genes; choose another encoding, or another operator",
             {"encoding", "development", "mutation"});
}

void check_notes(const TomlReader& t, const std::vector<NoteTitle>& notes) {
  for (auto note = notes.begin(); note != notes.end(); ++note) {
    if (note->name.empty()) t.fail("name", "this operator has a note without a name; name it in notes()");
    for (const std::string& text : {note->name, note->unit})
      if (const std::string fault = text_fault(text); !fault.empty())
        t.fail("name", "its note's name or unit " + fault);
    if (std::any_of(notes.begin(), note, [&](const NoteTitle& other) { return other.name == note->name; }))
      t.fail("name", "it has two notes \"" + note->name + "\"; rename one of them in notes()");
  }
}

class SelectionTables {
 public:
  SelectionTables(const OperatorFactory& factory, const References& references, Experiment& experiment)
      : factory_(factory), references_(references), out_(experiment) {}

  void read(TomlReader& top, toml::table& record) {
    const toml::table* table = top.table("selection");
    const auto names = [&](const char* name) { return table != nullptr && (*table)[name].is_table(); };
    toml::table written;
    const auto read_remeasure = [&](TomlReader& t) {
      TomlWriter writer;
      declare_remeasure(t, out_);
      declare_remeasure(writer, out_);
      written = writer.take();
    };
    if (names("parents") || names("survivors"))
      read_table(top, "selection", true, [&](TomlReader& t) {
        read_remeasure(t);
        out_.selection = read_one(t, "survivors", {.parents = false}, written);
        out_.parent_selection = read_one(t, "parents", {.survivors = false}, written);
      });
    else
      visit_table(
          top, "selection", true,
          [&](TomlReader& t) {
            read_remeasure(t);
            out_.selection = read(t, {}, written);
          },
          references_);
    record.insert_or_assign("selection", std::move(written));
  }

 private:
  std::unique_ptr<Selection> read_one(TomlReader& parent, const char* name, const Choice& choice, toml::table& record) {
    std::unique_ptr<Selection> op;
    toml::table written;
    visit_table(
        parent, name, true, [&](TomlReader& t) { op = read(t, choice, written); }, references_);
    record.insert(name, std::move(written));
    return op;
  }

  std::unique_ptr<Selection> read(TomlReader& t, const Choice& choice, toml::table& record) {
    std::unique_ptr<Selection> op = factory_.make<Selection>(t);
    TomlWriter writer;
    factory_.write(t, *op, writer);
    for (auto&& [key, value] : writer.take()) record.insert_or_assign(key, value);
    const auto memory = factory_.ask(t, [&] { return checked_names(op->memory(), "memory"); });
    check_choice(t, op->overrides, !memory.empty(), choice);
    check_traits(t, factory_.ask(t, [&] { return op->traits(); }), out_);
    const bool makes_children = choice.parents && op->overrides.children;
    if (makes_children) out_.child_maker = out_.uses.back().name;
    if (!choice.survivors && !makes_children) return op;
    (choice.survivors ? out_.notes : out_.child_notes) = factory_.ask(t, [&] { return op->notes(); });
    check_notes(t, out_.note_titles());
    return op;
  }

  const OperatorFactory& factory_;
  const References& references_;
  Experiment& out_;
};

}  // namespace

bool asks_for_random_individuals(TomlReader& top) {
  const toml::table* table = top.table("experiment");
  return table != nullptr && table->contains("random_individuals");
}

void read_selection(TomlReader& top, const OperatorFactory& factory, const References& references,
                    Experiment& experiment, toml::table& record) {
  top.attempt([&] {
    SelectionTables(factory, references, experiment).read(top, record);
    if (!experiment.makes_children() || asks_for_random_individuals(top)) return;
    experiment.random_individuals = 0;
    record["experiment"].as_table()->insert_or_assign("random_individuals", 0);
  });
}

}  // namespace evodevo
