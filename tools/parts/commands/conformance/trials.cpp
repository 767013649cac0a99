#include "conformance/trials.hpp"

#include <algorithm>
#include <bit>
#include <set>

#include "base/genome_sections.hpp"
#include "base/philox.hpp"
#include "conformance/behaviours.hpp"
#include "conformance/tables.hpp"
#include "evodevo/neat.hpp"
#include "operators/isolation.hpp"

namespace evodevo::conformance {
namespace {

// which the overloads below would otherwise hide
using conformance::append;
using conformance::numbers_of;

void append(Numbers& numbers, std::initializer_list<double> more) { numbers.insert(numbers.end(), more); }
void append(Numbers& numbers, Vec3 v) { append(numbers, {v.x, v.y, v.z}); }

void append(Numbers& numbers, const Material& m) {
  append(numbers, {m.stiffness, m.amplitude, m.frequency, m.phase, m.damping});
}

void append(Numbers& numbers, const std::vector<Block>& blocks) {
  for (const Block& block : blocks)
    append(numbers, {double(block.type), double(block.count), double(block.id >> 32), double(block.id & 0xffffffff)});
}

void append(Numbers& numbers, const Body& body) {
  for (const Mass& m : body.masses) {
    append(numbers, m.rest);
    append(numbers, {m.mass, double(m.material), double(m.air_contacts)});
  }
  for (const Spring& s : body.springs)
    append(numbers, {double(s.a), double(s.b), s.rest_length, double(s.material), s.stiffness_factor});
  for (const Material& m : body.materials) append(numbers, m);
}

Numbers numbers_of(const Layout& layout) {
  Numbers numbers;
  for (const BlockType& type : layout.types) {
    append(numbers, {double(type.least), double(type.most), double(type.section)});
    for (const GeneSpec& gene : type.genes)
      append(numbers, {gene.low, gene.high, double(gene.choices), gene.refers_to ? double(*gene.refers_to) : -1.0});
  }
  append(numbers, layout.first_blocks);
  return numbers;
}

Numbers numbers_of(const EncodingContext& context) {
  Numbers numbers{context.mass};
  for (const Material& material : context.materials) append(numbers, material);
  return numbers;
}

Numbers numbers_of(const SampleLife& life) {
  Numbers numbers;
  for (const auto list : SpringRecords::lists) append(numbers, life.living.*list);
  for (const auto list : MassRecords::lists) append(numbers, life.living.*list);
  for (const OperatorMemory& memory : life.living.memory) {
    append(numbers, memory.masses.values);
    append(numbers, memory.springs.values);
  }
  append(numbers, life.living.body);
  for (const Vec3& position : life.living.state.position) append(numbers, position);
  for (const Vec3& velocity : life.living.state.velocity) append(numbers, velocity);
  append(numbers, numbers_of(life.genome));
  append(numbers, numbers_of(life.layout));
  return numbers;
}

void require_untouched(const char* what, const Numbers& before, const Numbers& after) {
  if (!same(before, after)) throw Violation(std::string("it changes ") + what + ", which it may only read");
}

Numbers try_encoding(const Subject& subject, const Encoding& op, std::uint64_t seed, std::uint32_t input) {
  const EncodingContext context = subject.context();
  const Layout layout = op.layout(context);
  const Numbers layout_before = numbers_of(layout);
  Rng rng = stream(seed, input);
  const Genome genome = op.random(layout, rng);
  const Numbers genome_before = numbers_of(genome);
  const Blueprint blueprint = op.decode(genome, layout, context);
  require_untouched("the context", numbers_of(subject.context()), numbers_of(context));
  require_untouched("the layout", layout_before, numbers_of(layout));
  require_untouched("the genome that it decodes", genome_before, numbers_of(genome));
  Numbers result = genome_before;
  append(result, blueprint.body);
  for (const Vec3& position : blueprint.paired_at) append(result, position);
  for (const Vec3& position : blueprint.origins) append(result, position);
  for (const auto* given : {&blueprint.mass_memory, &blueprint.spring_memory})
    for (const auto& [name, memory] : *given) append(result, memory);
  append(result, {double(blueprint.neighbours), double(blueprint.failure.size())});
  return result;
}

Numbers try_mutation(const Subject& subject, const Mutation& op, std::uint64_t seed, std::uint32_t input) {
  Rng rng = stream(seed, input);
  auto [layout, genome] = sample_genes(op, sample_genomes(subject, op, input), rng);
  const Numbers layout_before = numbers_of(layout);
  op.mutate(genome, {layout, generation_of(input)}, rng);
  require_untouched("the layout", layout_before, numbers_of(layout));
  return numbers_of(genome);
}

Numbers try_crossover(const Subject& subject, const Crossover& op, std::uint64_t seed, std::uint32_t input) {
  const auto [layout, draw] = sample_genomes(subject, op, input);
  Rng rng = stream(seed, input);
  const Genome first = draw(rng), second = draw(rng);
  const Numbers first_before = numbers_of(first), second_before = numbers_of(second);
  const Genome child = op.cross({first, second, input % 4 < 2}, {layout, generation_of(input)}, rng);
  require_untouched("the layout", numbers_of(sample_genomes(subject, op, input).layout), numbers_of(layout));
  require_untouched("the first parent", first_before, numbers_of(first));
  require_untouched("the second parent", second_before, numbers_of(second));
  return numbers_of(child);
}

Numbers try_devo(const Subject& subject, const Devo& op, std::uint64_t seed, std::uint32_t input) {
  const SampleLife life = sample_life(subject, op, seed, input);
  Edits edits(life.living.body);
  Rng rng = stream(seed, input, 1);
  op.develop(life.context(op.observes()), edits, rng);
  require_untouched("the body, its state, its records, its memory or its genes",
                    numbers_of(sample_life(subject, op, seed, input)), numbers_of(life));
  return numbers_of(edits);
}

Numbers try_fitness(const Fitness& op, std::uint64_t seed, std::uint32_t input) {
  const Request request = op.observes();
  const SampleBehaviour behaviour = sample_behaviour(request, seed, input);
  const auto digest = [](const SampleBehaviour& b) {
    const Observation& o = b.observation;
    Numbers numbers{o.window};
    for (const Vec3& v : {o.box.low, o.box.high, o.centre_before, o.centre_after}) append(numbers, v);
    for (const StoredSample& sample : b.samples) append(numbers, sample.centre);
    return numbers;
  };
  const Numbers before = digest(behaviour);
  Numbers result = op.score(behaviour.observation);
  require_untouched("the observation", before, digest(behaviour));
  append(result, {request.settle, request.window, double(request.work), request.rate, double(op.objectives().size())});
  return result;
}

}  // namespace

bool same(const Numbers& a, const Numbers& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

std::uint32_t generation_of(std::uint32_t input) { return input % 4 == 3 ? 1'000'000 : 1 + input; }

Rng stream(std::uint64_t seed, std::uint32_t input, std::uint32_t part) { return Rng(philox, {seed, input, part, 0}); }

SampleGenes sample_genes(const Mutation& op, const SampleGenomes& others, Rng& rng) {
  SampleGenes sample{.layout = {.sections = {}}, .genome = {}};
  std::vector<Genome> sections = {others.draw(rng)};
  if (others.layout.sections.size() > 1) {  // those of an experiment's operators
    sample.layout = others.layout;
    sections = split(sections.front(), others.layout);
  } else {
    add_section(sample.layout, "sample", others.layout);
  }
  const Layout own = op.layout(others.layout);
  if (!own.types.empty()) {
    sample.layout.own = add_section(sample.layout, "own", own);
    sections.push_back(op.random(own, rng));
  }
  sample.genome = join(sections, sample.layout);
  require_within(sample.genome, sample.layout);
  return sample;
}

void require_within(const Genome& genome, const Layout& layout) {
  if (const std::string fault = genome_fault(genome, layout); !fault.empty())
    throw Violation("it makes a genome with " + fault);
}

Numbers numbers_of(const Genome& genome) {
  Numbers numbers(genome.begin(), genome.end());
  append(numbers, genome.blocks);
  return numbers;
}

Numbers numbers_of(const Edits& edits) {
  Numbers numbers;
  for (const std::vector<Removal>* removals : {&edits.removed_springs, &edits.removed_masses})
    for (const auto& [index, cause] : *removals) append(numbers, {double(index), cause});
  if (edits.scaling)
    append(numbers, {double(edits.scaling->number), edits.scaling->from, edits.scaling->to, edits.scaling->whole});
  for (const ChangedSpring& s : edits.changed_springs) {
    append(numbers, {double(s.spring), s.rest_length.value_or(-1), s.stiffness_factor.value_or(-1), s.cause});
    append(numbers, s.material.value_or(Material{}));
  }
  for (const NewMass& m : edits.new_masses) {
    append(numbers, m.position);
    append(numbers, {m.mass.value_or(-1), double(m.material), m.cause});
  }
  for (const NewSpring& s : edits.new_springs) {
    append(numbers, {double(s.a), double(s.b), s.rest_length.value_or(-1), s.stiffness_factor,
                     s.like ? double(*s.like) : -1.0, s.cause});
    append(numbers, s.material);
  }
  for (const MemoryEdits* memory : {&edits.mass_memory, &edits.spring_memory}) {
    numbers.insert(numbers.end(), memory->items.begin(), memory->items.end());
    append(numbers, memory->values);
  }
  if (edits.body_memory) append(numbers, *edits.body_memory);
  return numbers;
}

DevoContext SampleLife::context(const RecordRequest& request) const {
  DevoContext context{.body = living.body,
                      .state = living.state,
                      .cycle = cycle,
                      .cycles = 20,
                      .application = cycle,
                      .applications = 20,
                      .time = 0.5 * cycle,
                      .bounds = bounds,
                      .mass = 0.2,
                      .resets = resets,
                      .genome = genome,
                      .layout = layout,
                      .own = own,
                      .mass_memory = living.memory.front().masses.view("mass"),
                      .spring_memory = living.memory.front().springs.view("spring"),
                      .body_memory = {living.memory.front().body, "body"},
                      .first_time = 0.5,
                      .last_time = 10,
                      .identities = living.numbers.identities(),
                      .daughters = living.numbers.daughters(),
                      .draws = Draws(philox, mixed(4, static_cast<std::uint64_t>(cycle)), 5, inherits)};
  show_records(living, request, context);
  return context;
}

namespace {

/// Makes up the records of the masses and what the operator remembers: at birth `given` about each spring, under every
/// name that it needs then. Degree and load are those of the body.
void add_experience(const Devo& op, bool has_lived, const std::vector<double>& given, Rng& rng, LivingBody& living) {
  record_masses({.degree = true, .load = true}, living);
  for (std::size_t i = 0; i < living.body.masses.size(); ++i) {
    living.contact.push_back(std::max(0.0, rng.uniform(-1, 1)));  // about half of the masses touch no ground
    living.age.push_back(1 + rng.below(20));
  }
  BuiltBody born{.body = living.body};
  for (const std::string& name : op.traits().needs_at_birth) born.spring_memory[name] = given;
  OperatorMemory& memory = living.memory.emplace_back(memory_at_birth(memory_names(op), born));
  if (!has_lived) return;
  for (std::vector<double>* values : {&memory.masses.values, &memory.springs.values, &memory.body})
    for (double& value : *values) value = rng.uniform();
}

}  // namespace

SampleLife sample_life(const Subject& subject, const Devo& op, std::uint64_t seed, std::uint32_t input,
                       std::optional<std::uint32_t> count) {
  Rng rng = stream(seed, input), own_rng = stream(seed, input, 2);
  SampleLife life;
  const SampleGenomes genomes = sample_genomes(subject, op, 0);
  life.layout = genomes.layout;
  life.genome = genomes.draw(rng);
  if (const Layout own = op.layout(subject.context()); !own.types.empty()) {
    life.own = op.random(own, own_rng);
    require_within(life.own, own);
  }
  life.resets = input % 3 == 2;
  Body& body = life.living.body;
  body.materials = subject.context().materials;
  const auto materials = static_cast<std::uint32_t>(body.materials.size());
  body.base_materials = materials;
  // every eighth body has only two masses, a case that operators often do not consider
  const std::uint32_t masses = count ? *count : input % 8 == 7 ? 2 : 12 + rng.below(24);
  const bool masses_have_materials = input % 2 == 0;
  for (std::uint32_t i = 0; i < masses; ++i) {
    const Vec3 position{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0, 1)};
    body.masses.push_back({position, 0.2, masses_have_materials ? std::int32_t(rng.below(materials)) : no_material, 0});
    life.living.state.position.push_back(life.resets ? position : 1.25 * position);
    life.living.state.velocity.push_back({rng.uniform(-1, 1), 0, 0});
  }
  const bool may_be_parallel = input % 4 == 1;  // as in voxels with springs of their own
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::vector<double> given;
  for (std::uint32_t i = 0; i < 5 * masses; ++i) {
    const std::uint32_t a = rng.below(masses), b = rng.below(masses);
    if (a == b || (!pairs.insert(std::minmax(a, b)).second && !may_be_parallel)) continue;
    const double length = norm(body.masses[a].rest - body.masses[b].rest);
    const Material stiff{1000.0 + rng.below(3), 0.1, 1, 0};
    given.push_back(rng.uniform(-0.2, 0.25));
    body.springs.push_back({a, b, length, body.material_index(stiff), length});
    const double stress = rng.uniform(0, 100);
    life.living.stress.push_back(stress);
    life.living.peak_force.push_back(stress * rng.uniform(1, 3));
    life.living.muscle_work.push_back(rng.uniform(0, 5));
    life.living.tension.push_back(stress * rng.uniform(-1, 1));
  }
  life.bounds = bounding_box(life.living.state.position);
  life.inherits = input % 16 >= 8;
  std::vector<std::uint64_t> identities;
  for (std::uint64_t i = 0; i < masses; ++i) identities.push_back(mixed(7, i));
  life.living.numbers = MassNumbers(std::move(identities));
  Rng experience_rng = stream(seed, input, 100);
  add_experience(op, input % 4 >= 2, given, experience_rng, life.living);
  if (input % 4 >= 2)
    for (Spring& spring : body.springs) spring.stiffness_factor = experience_rng.uniform(0.5, 2);
  return life;
}

SampleLife without_mass(const SampleLife& life, std::uint32_t mass) {
  SampleLife without = life;
  Edits edits;
  edits.remove_mass(mass);
  apply(edits, without.living);
  return without;
}

Numbers try_out(const Subject& subject, const Operator& op, std::uint64_t seed, std::uint32_t input) {
  const std::string kind = subject.kind();
  if (kind == Encoding::kind) return try_encoding(subject, static_cast<const Encoding&>(op), seed, input);
  if (kind == Mutation::kind) return try_mutation(subject, static_cast<const Mutation&>(op), seed, input);
  if (kind == Crossover::kind) return try_crossover(subject, static_cast<const Crossover&>(op), seed, input);
  if (kind == Devo::kind) return try_devo(subject, static_cast<const Devo&>(op), seed, input);
  if (kind == Fitness::kind) return try_fitness(static_cast<const Fitness&>(op), seed, input);
  return try_selection(subject, static_cast<const Selection&>(op), seed, input);
}

std::uint32_t inputs_for(const Subject& subject) {
  return subject.kind() == Encoding::kind ? 4 : 16;  // bodies of encodings may have thousands of masses
}

Numbers try_new(const Subject& subject, std::uint64_t seed, std::uint32_t input) {
  return try_out(subject, *create<Operator>(subject), seed, input);
}

std::string in_new_process(const std::function<std::string()>& work) {
  constexpr unsigned seconds = 60;
  const auto guarded = [&] {
    try {
      return "+" + work();
    } catch (const Skipped& reason) {
      return "?" + std::string(reason.what());
    } catch (const std::exception& error) {
      return "-" + std::string(error.what());
    }
  };
  const ChildEnd end = in_child(guarded, seconds);
  if (!end.crash.empty()) throw Violation("in a process of its own it crashes: " + end.crash);
  if (end.text.starts_with('?')) throw Skipped(end.text.substr(1));
  if (end.text.starts_with('-')) throw Violation(end.text.substr(1));
  return end.text.substr(1);
}

}  // namespace evodevo::conformance
