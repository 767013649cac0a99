#include "conformance/subject.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>

#include "base/genome_sections.hpp"
#include "base/philox.hpp"
#include "base/text.hpp"
#include "evodevo/neat.hpp"
#include "evolution/breeding.hpp"
#include "operators/declarations.hpp"
#include "operators/host_keys.hpp"

namespace evodevo::conformance {
namespace {

namespace fs = std::filesystem;

/// Returns the table of an experiment for the operator with this index among those of its kind.
toml::table table_of(const toml::table& tables, std::string_view kind, std::size_t index) {
  const toml::node_view<const toml::node> node = kind == Devo::kind ? tables["development"]["operator"] : tables[kind];
  if (const toml::table* one = node.as_table()) {
    const toml::table* apart = (*one)[index == 0 ? "survivors" : "parents"].as_table();
    return apart != nullptr ? *apart : *one;
  }
  return *node.as_array()->get(index)->as_table();
}

bool has_types(const Layout& layout, const std::vector<std::string>& wanted) {
  return std::all_of(wanted.begin(), wanted.end(), [&](const std::string& name) {
    return std::any_of(layout.types.begin(), layout.types.end(), [&](const auto& type) { return type.name == name; });
  });
}

/// Adds a block with random genes.
void add_random_block(Genome& genome, const Layout& layout, std::uint32_t type, Rng& rng) {
  const std::vector<float> genes(layout.types[type].genes.size(), 0);
  const Block block = genome.blocks[add_block(genome, layout, type, genes, fresh_id(rng))];
  for (std::uint32_t gene = block.first; gene < block.first + block.count; ++gene)
    genome[gene] = layout.draw(genome, gene, rng);
}

/// Genomes whose blocks may be others than those of first genomes.
SampleGenomes restructured(Layout layout, std::function<Genome(Rng&)> first) {
  const auto draw = [layout, first = std::move(first)](Rng& rng) {
    Genome genome = first(rng);
    restructure(genome, layout, rng);
    return genome;
  };
  return {layout, draw};
}

/// The genomes of an experiment, or those sections of them on which a variation operator works.
SampleGenomes genomes_of(const Use& use, std::string_view kind) {
  const Experiment& experiment = use.experiment;
  SectionIndices sections = {0};
  if (kind == Crossover::kind) sections = experiment.crossovers.at(use.index).sections;
  if (kind == Mutation::kind) {
    sections = experiment.mutations.at(use.index).sections;
    if (const auto own = experiment.mutations.at(use.index).own_section) std::erase(sections, *own);
  }
  if (kind == Selection::kind) {
    sections.resize(experiment.layout.sections.size());
    std::iota(sections.begin(), sections.end(), 0u);
  }
  const Layout layout = some_sections(experiment.layout, sections);
  return restructured(layout, [&experiment, sections, layout](Rng& rng) {
    const std::uint64_t seed = rng();
    const Genome whole = first_genome(experiment, [&](std::uint32_t section) { return Rng(philox, {seed, section}); });
    return part_of(whole, experiment.layout, sections, layout);
  });
}

Layout sample_layout(std::uint32_t input) {
  Layout layout;
  if (input % 2 == 0) {
    layout.add_block(7, {-1, 1});
    layout.add_block(1, {0, 0, 5});
    layout.add_block(3, {0, 0.25});
    layout.add_block(6, {0, 0, 2});
    return layout;
  }
  const neat::Types types = neat::add_types(layout, 2, {"linear", "sine", "step"}, 9, 12);
  for (int i = 0; i < 4; ++i) layout.add_block_of(types.node);
  for (int i = 0; i < 5; ++i) layout.add_block_of(types.link);
  return layout;
}

toml::table with_name(const std::string& name) { return toml::table{{host_key::name, name}}; }

/// Returns the encoding of the same library whose genomes have blocks of all the given types. Throws Skipped if there
/// is none.
const AvailableOperator& encoding_with(const Subject& subject, const std::vector<std::string>& block_types) {
  for (const AvailableOperator& other : subject.siblings) {
    if (std::string_view(other.entry->kind) != Encoding::kind) continue;
    const Subject encoding{other, subject.siblings};
    try {
      if (has_types(create<Encoding>(encoding)->layout(encoding.context()), block_types)) return other;
    } catch (const Skipped&) {
      // this one requires a parameter
    }
  }
  throw Skipped("it works on blocks of the type \"" + printable(block_types.front()) +
                "\"; name an experiment that uses it and whose genomes have such blocks: --experiment FILE");
}

/// Returns the encoding for a small experiment with another operator: one whose genomes have the blocks on which the
/// operator works.
toml::table encoding_for(const Subject& subject) {
  const Traits traits = create_operator(subject)->traits();
  if (traits.needs_real_genes) return toml::table{{host_key::name, "neural"}, {"points", 12}, {"neighbours", 4}};
  const std::vector<std::string>& wanted = traits.block_types;
  if (wanted.empty()) return toml::table{{host_key::name, "voxel"}, {"size", toml::array{2, 1, 1}}, {"edge", 0.5}};
  if (subject.use) return table_of(subject.use->tables, Encoding::kind, 0);
  if (has_types(sample_layout(1), wanted))
    return toml::table{{host_key::name, "neat"}, {"points", 30}, {"neighbours", 6}};
  return with_name(encoding_with(subject, wanted).entry->name);
}

}  // namespace

EncodingContext Subject::context() const {
  if (use) return use->experiment.context;
  EncodingContext context;
  for (const auto& [name, material] : base_materials()) {
    context.material_names.push_back(name);
    context.materials.push_back(material);
  }
  context.philox = philox;
  return context;
}

std::vector<fs::path> Subject::plugin_path() const {
  std::vector<fs::path> path = {available.file};
  if (use) path.insert(path.end(), use->experiment.plugin_folders.begin(), use->experiment.plugin_folders.end());
  return path;
}

std::optional<Use> use_in(const Experiment& experiment, const AvailableOperator& available) {
  std::size_t index = 0;
  for (const OperatorUse& use : experiment.uses) {
    if (use.kind != available.entry->kind) continue;
    if (use.name == available.entry->name && fs::equivalent(use.file, available.file)) {
      const toml::table tables = parse_toml(experiment.resolved, "the experiment");
      return Use{experiment, index, tables, table_of(tables, use.kind, index)};
    }
    ++index;
  }
  return std::nullopt;
}

void set_parameters(Operator& op, const Subject& subject) {
  if (!subject.use) {
    if (const std::string name = required_parameter(op); !name.empty())
      throw Skipped("its parameter \"" + name +
                    "\" has no default; name an experiment that uses it: --experiment FILE");
    return op.prepare(subject.context());
  }
  const Experiment& experiment = subject.use->experiment;
  TomlReader reader(subject.use->own, subject.kind(), {&experiment.context.material_names, {}, &experiment.files});
  op.parameters(reader);
  op.prepare(experiment.context);
}

std::unique_ptr<Operator> create_operator(const Subject& subject) {
  auto op = evodevo::create<Operator>(subject.available);
  in_operator({subject.available.title}, [&] { set_parameters(*op, subject); });
  return op;
}

SampleGenomes sample_genomes(const Subject& subject, const Operator& op, std::uint32_t input) {
  if (subject.use) return genomes_of(*subject.use, subject.kind());
  const std::vector<std::string> wanted = op.traits().block_types;
  for (const std::uint32_t one : {input, 1u})
    if (const Layout layout = sample_layout(one); has_types(layout, wanted))
      return restructured(layout, [layout](Rng& rng) { return random_genome(layout, rng); });
  const AvailableOperator& available = encoding_with(subject, wanted);
  const std::shared_ptr<const Encoding> encoding = create<Encoding>(Subject{available, subject.siblings});
  const Layout layout = encoding->layout(subject.context());
  return restructured(layout, [encoding, layout](Rng& rng) { return encoding->random(layout, rng); });
}

void restructure(Genome& genome, const Layout& layout, Rng& rng) {
  if (layout.is_fixed()) return;
  for (std::uint32_t type = 0; type < layout.types.size(); ++type)
    if (count_blocks(genome, layout, type) < layout.types[type].most) add_random_block(genome, layout, type, rng);
  Genome fewer = genome;
  remove_block(fewer, layout, rng.below(static_cast<std::uint32_t>(genome.blocks.size())));
  if (is_within_limits(fewer, layout)) genome = std::move(fewer);
}

/// Makes the life of an experiment long enough for the window of a fitness operator, if it lies within the life.
void fit_life(const Request& request, toml::table& development) {
  if (!request.cycle) return;
  development.insert_or_assign("cycles", *request.cycle + 2);
  development.insert_or_assign("cycle_time", std::max(0.05, (request.settle + request.window) / 2 + 0.05));
}

/// Adds fitness operators to one that has an objective, until a selection operator has as many scores as it needs.
void add_scores(const Traits& traits, toml::array& fitness) {
  const auto add = [&](const char* name, std::uint32_t number) {
    fitness.push_back(toml::table{
        {host_key::name, name}, {host_key::label, name + std::to_string(number)}, {"settle", 0.0}, {"window", 0.1}});
  };
  for (std::uint32_t i = 1; i < traits.least_objectives; ++i) add("actuation-work", i);
  for (std::uint32_t i = 0; i < traits.least_descriptors; ++i) add("descriptor", i);
}

/// Returns the table [selection] of a small experiment with a selection operator, whose own table is `own`.
toml::table selection_with(const toml::table& own, const Overrides& has) {
  if (!has.survivors) return toml::table{{"parents", own}, {"survivors", with_name("elitist")}};
  if (!has.parents && !has.children) return toml::table{{"parents", with_name("elitist")}, {"survivors", own}};
  return own;
}

std::string small_experiment(const Subject& subject, std::uint64_t seed) {
  toml::table root = parse_toml(
      "[experiment]\n[scene.gravity]\n[scene.floor]\n[scene.friction]\n"
      "[scene.damping]\n[simulation]\ndevice = \"cpu\"\nthreads = 2\n[development]\ncycles = 2\ncycle_time = 0.05\n",
      "the conformance kit's experiment");
  const auto op = create_operator(subject);
  const Traits traits = op->traits();
  const bool is_selection = subject.kind() == Selection::kind;
  const Overrides has = is_selection ? static_cast<const Selection&>(*op).overrides : Overrides();
  const std::int64_t population = std::max({6u, traits.least_population, traits.least_children});
  toml::table& experiment = *root["experiment"].as_table();
  experiment.insert("seed", static_cast<std::int64_t>(seed % (1u << 31)));
  experiment.insert("population", population);
  experiment.insert("evaluations", 4 * population);
  toml::table own = with_name(subject.name());
  if (subject.use) {
    own = subject.use->own;
    for (const std::string_view key : {host_key::from, host_key::to, host_key::every, host_key::sections})
      own.erase(key);
    if (const toml::table* materials = subject.use->tables["materials"].as_table())
      root.insert("materials", *materials);
  }
  const auto either = [&](std::string_view kind, toml::table otherwise) {
    return subject.kind() == kind ? own : std::move(otherwise);
  };
  toml::table mutation = either(Mutation::kind, with_name("reset-weight")),
              crossover = either(Crossover::kind, with_name("two-point"));
  mutation.insert_or_assign(host_key::probability, 0.8);
  crossover.insert_or_assign(host_key::probability, 0.5);
  root.insert("encoding", subject.kind() == Encoding::kind ? own : encoding_for(subject));
  if (!has.children) {
    root.insert("mutation", toml::array{std::move(mutation)});
    root.insert("crossover", toml::array{std::move(crossover)});
  }
  root["development"].as_table()->insert(
      "operator", toml::array{either(Devo::kind, toml::table{{host_key::name, "spring-turnover"}, {"springs", 2}})});
  toml::array fitness;
  if (subject.kind() == Fitness::kind) {
    fitness.push_back(own);
    fit_life(create<Fitness>(subject)->observes(), *root["development"].as_table());
  }
  // the operator itself may have no objective
  fitness.push_back(
      toml::table{{host_key::name, "distance"}, {host_key::label, "way"}, {"settle", 0.0}, {"window", 0.1}});
  add_scores(traits, fitness);
  root.insert("fitness", std::move(fitness));
  root.insert("selection", is_selection ? selection_with(own, has) : with_name("elitist"));
  std::ostringstream text;
  text << root << '\n';
  return text.str();
}

}  // namespace evodevo::conformance
