// Test cases for operators of one kind.
#include <algorithm>
#include <cmath>
#include <set>

#include "base/genome_sections.hpp"
#include "base/text.hpp"
#include "conformance/behaviours.hpp"
#include "conformance/conformance.hpp"
#include "conformance/trials.hpp"
#include "life/body_building.hpp"

namespace evodevo::conformance {
namespace {

std::string numbered(const char* what, std::uint32_t input) { return std::string(what) + " " + std::to_string(input); }

// ---- encodings ----

/// Throws unless the blueprint is correct and all of its positions are finite. A run is more tolerant: it treats a body
/// whose positions are not finite as invalid.
void require_sound(const Encoding& op, const Blueprint& blueprint, const EncodingContext& context) {
  check_blueprint(blueprint, context, op.spring_memory());
  for (const Mass& mass : blueprint.body.masses)
    if (!std::isfinite(norm(mass.rest))) throw Violation("the position of a mass is not finite");
  build_body(blueprint, [&](std::size_t, Blueprint& joined) { complete(op, context, joined); });
}

/// Checks that every genome gives a sound body or a reason why there is none, and that not all fail.
void decodes(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Encoding>(subject);
  const EncodingContext context = subject.context();
  const Layout layout = op->layout(context);
  std::string reason;
  std::uint32_t bodies = 0;
  for (std::uint32_t input = 0; input < 12; ++input) {
    Rng rng = stream(seed, input);
    Genome genome = op->random(layout, rng);
    require_within(genome, layout);
    if (input % 2 == 1) restructure(genome, layout, rng);
    const auto genes = static_cast<std::uint32_t>(genome.size());
    for (std::uint32_t changed = 0; changed < std::min(genes, input); ++changed) {
      const std::uint32_t gene = rng.below(genes);
      genome[gene] = layout.draw(genome, gene, rng);
    }
    const Blueprint blueprint = op->decode(genome, layout, context);
    reason = blueprint.failure;
    if (!reason.empty()) continue;
    if (blueprint.body.masses.empty()) throw Violation("a blueprint has neither masses nor a failure that says why");
    require_sound(*op, blueprint, context);
    ++bodies;
  }
  if (bodies == 0) throw Violation("none of the genomes that were tried gives a body: " + reason);
}

void layout_is_whole(const Subject& subject, std::uint64_t) {
  if (const std::string fault = layout_fault(create<Encoding>(subject)->layout(subject.context())); !fault.empty())
    throw Violation("its layout is not usable: " + fault);
}

// ---- variation ----

constexpr std::uint32_t tries_to_change = 200;

void nothing_stays_nothing(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Mutation>(subject);
  Rng rng = stream(seed, 0);
  auto [layout, genome] = sample_genes(*op, {{}, [](Rng&) { return Genome(); }}, rng);
  const std::size_t own = genome.size();
  op->mutate(genome, {layout, 1}, rng);
  if (genome.size() != own) throw Violation("it adds genes to a genome that has no genes");
}

/// Checks that the mutation changes at least one of many genomes. If it never changes any, all of its children are
/// clones.
void mutates(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Mutation>(subject);
  for (std::uint32_t input = 0; input < tries_to_change; ++input) {
    Rng rng = stream(seed, input);
    const auto [layout, genome] = sample_genes(*op, sample_genomes(subject, *op, input), rng);
    Genome mutant = genome;
    op->mutate(mutant, {layout, generation_of(input)}, rng);
    if (mutant != genome) return;
  }
  throw Violation("it changes none of " + std::to_string(tries_to_change) + " genomes, so its children are clones");
}

void mutants_fit(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Mutation>(subject);
  for (const std::uint32_t input : {0, 1}) {
    Rng rng = stream(seed, input);
    auto [layout, genome] = sample_genes(*op, sample_genomes(subject, *op, input), rng);
    for (std::uint32_t i = 0; i < 200; ++i) {
      op->mutate(genome, {layout, generation_of(i)}, rng);
      require_within(genome, layout);
    }
  }
}

void twins_stay_twins(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Crossover>(subject);
  for (std::uint32_t input = 0; input < 50; ++input) {
    const auto [layout, draw] = sample_genomes(subject, *op, input);
    Rng rng = stream(seed, input);
    const Genome genome = draw(rng), twin = genome;
    if (op->cross({genome, twin}, {layout, generation_of(input)}, rng) != genome)
      throw Violation("the child of two equal genomes differs from them");
  }
}

/// Checks that the child differs from the first parent for at least one of many pairs.
void crosses(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Crossover>(subject);
  for (std::uint32_t input = 0; input < tries_to_change; ++input) {
    const auto [layout, draw] = sample_genomes(subject, *op, input);
    Rng rng = stream(seed, input);
    const Genome first = draw(rng), second = draw(rng);
    if (op->cross({first, second}, {layout, generation_of(input)}, rng) != first) return;
  }
  throw Violation("for all of " + std::to_string(tries_to_change) +
                  " pairs of genomes it returns the first genome, so its children are clones");
}

void children_fit(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Crossover>(subject);
  Rng rng = stream(seed, 0);
  for (std::uint32_t input = 0; input < 200; ++input) {
    const auto [layout, draw] = sample_genomes(subject, *op, input);
    const Genome first = draw(rng), second = draw(rng);
    require_within(op->cross({first, second, input % 4 < 2}, {layout, generation_of(input)}, rng), layout);
  }
}

// ---- development ----

void require_measures(const Devo& op) {
  for (const EditKind edit : edit_kinds)
    if (const Measure measure = op.measure(edit); measure.name.empty() || measure.unit.empty())
      throw Violation("measure() returns no name or no unit; the unit of a pure number is \"1\"");
}

/// Checks over several cycles that the host can apply all edits, and keep what the operator remembers, that new masses
/// do not lie below the bounds, and that some body still has springs after the first cycle.
void bodies_stay_sound(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Devo>(subject);
  require_measures(*op);
  bool edited = false, some_body_holds = false;
  for (std::uint32_t input = 0; input < 24; ++input) {
    SampleLife life = sample_life(subject, *op, seed, input);
    for (life.cycle = 1; life.cycle <= 10; ++life.cycle) {
      Rng rng = stream(seed, input, static_cast<std::uint32_t>(life.cycle));
      const DevoContext context = life.context(op->observes());
      Edits edits(context.body);
      op->develop(context, edits, rng);
      if (edits.failure) break;
      edited = edited || !edits.empty();
      for (const NewMass& mass : edits.new_masses) {
        // written so that NaN fails
        if (!std::isfinite(norm(mass.position)) || !(mass.position.z >= context.bounds.low.z))
          throw Violation(numbered("body", input) + ": a new mass lies below the bounds of the context");
      }
      try {
        OperatorMemory& memory = life.living.memory.front();
        remember(edits, memory_names(*op), life.living.body, memory);
        if (memory.springs_changed) write_out_scaling(edits, life.living.body, memory.springs);
        apply(resolved(edits, context), life.living, 0);
      } catch (const std::invalid_argument& error) {
        throw Violation(numbered("body", input) + ", " + numbered("cycle", std::uint32_t(life.cycle)) + ": it " +
                        error.what());
      }
      some_body_holds = some_body_holds || !life.living.body.springs.empty();
    }
  }
  if (!some_body_holds) throw Violation("it destroys every body: none has a spring after one cycle");
  if (!edited) throw Skipped("it edits none of the bodies");
}

/// The edits of an operator by identities: in which order they were made, and what their indices are, makes no
/// difference. Those that concern the mass of the identity `whose` or its springs are left out.
std::multiset<Numbers> by_identity(const Edits& edits, const DevoContext& context, std::uint64_t whose) {
  std::multiset<Numbers> listed;
  const std::size_t masses = context.body.masses.size();
  const auto identity = [&](std::uint32_t mass) {
    return mass < masses ? context.identity(mass) : edits.new_masses.at(mass - masses).identity.value();
  };
  const auto list = [&](double what, std::vector<std::uint32_t> whom, const Numbers& how) {
    std::vector<std::uint64_t> names;
    for (const std::uint32_t mass : whom) names.push_back(identity(mass));
    if (std::ranges::find(names, whose) != names.end()) return;
    std::ranges::sort(names);
    Numbers numbers{what};
    for (const std::uint64_t name : names) append(numbers, {double(name >> 32), double(name & 0xffffffff)});
    append(numbers, how);
    listed.insert(std::move(numbers));
  };
  const auto spring = [&](double what, std::uint32_t s, const Numbers& how) {
    list(what, {context.body.springs.at(s).a, context.body.springs.at(s).b}, how);
  };
  const auto of = [](const Material& m) { return Numbers{m.stiffness, m.amplitude, m.frequency, m.phase, m.damping}; };
  for (const Removal& removal : edits.removed_springs) spring(0, removal.index, {});
  for (const Removal& removal : edits.removed_masses) list(1, {removal.index}, {});
  for (const ChangedSpring& s : edits.changed_springs) {
    Numbers how{s.rest_length.value_or(-1), s.stiffness_factor.value_or(-1)};
    append(how, of(s.material.value_or(Material{})));
    spring(2, s.spring, how);
  }
  for (std::uint32_t i = 0; i < edits.new_masses.size(); ++i) {
    const NewMass& mass = edits.new_masses[i];
    list(3, {static_cast<std::uint32_t>(masses) + i},
         {mass.position.x, mass.position.y, mass.position.z, mass.mass.value(), double(mass.material)});
  }
  for (const NewSpring& s : edits.new_springs) {
    Numbers how{s.rest_length.value_or(-1), s.stiffness_factor, s.like ? 1.0 : 0.0};
    append(how, of(s.material));
    list(4, {s.a, s.b}, how);
  }
  return listed;
}

/// Checks what Traits::locality claims, for bodies of 200 masses.
void changes_stay_local(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Devo>(subject);
  const std::optional<std::uint32_t> claimed = op->traits().locality;
  if (!claimed) throw Skipped("its traits say nothing of locality");
  constexpr std::uint32_t masses = 200;
  bool edited = false;
  for (std::uint32_t input = 0; input < 8; ++input) {
    SampleLife whole = sample_life(subject, *op, seed, input, masses);
    whole.inherits = true;
    Rng which = stream(seed, input, 3);
    for (int trial = 0; trial < 8; ++trial) {
      const std::uint32_t mass = which.below(masses);
      const std::uint64_t whose = whole.living.numbers.identities()[mass];
      const auto edits_of = [&](const SampleLife& life) {
        const DevoContext context = life.context(op->observes());
        Edits edits(context.body);
        Rng rng = context.draws.stream("stream");
        op->develop(context, edits, rng);
        return by_identity(resolved(edits, context), context, whose);
      };
      const std::multiset<Numbers> with = edits_of(whole), without = edits_of(without_mass(whole, mass));
      edited = edited || !with.empty();
      std::vector<Numbers> only_with, only_without;
      std::ranges::set_difference(with, without, std::back_inserter(only_with));
      std::ranges::set_difference(without, with, std::back_inserter(only_without));
      const std::size_t others = std::max(only_with.size(), only_without.size());
      if (others > *claimed)
        throw Violation(numbered("body", input) + ": without mass " + std::to_string(mass) + ", " +
                        std::to_string(others) + " edits that do not concern it differ, of " +
                        std::to_string(with.size()) + "; its trait locality claims at most " +
                        std::to_string(*claimed));
    }
  }
  if (!edited) throw Skipped("it edits none of the bodies");
}

// ---- fitness ----

/// Checks that scores do not change if a body is moved horizontally (heights are relative to the floor). The distances
/// are powers of two, so that rounding errors are small.
void unmoved_by_translation(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Fitness>(subject);
  if (op->traits().depends_on_place) throw Skipped("its traits say that it depends on the place of the body");
  for (std::uint32_t input = 0; input < 20; ++input) {
    const Request request = op->observes();
    const SampleBehaviour here = sample_behaviour(request, seed, input),
                          there = sample_behaviour(request, seed, input, {8, -4, 0});
    const auto a = op->score(here.observation), b = op->score(there.observation);
    for (std::size_t i = 0; i < a.size(); ++i)
      if (!(std::abs(a[i] - b[i]) <= 1e-6 * (1 + std::abs(a[i]))) && (std::isfinite(a[i]) || std::isfinite(b[i])))
        throw Violation("a body that moves in the same way at another place scores " + to_text(b[i]) + " instead of " +
                        to_text(a[i]));
  }
}

/// Returns whether a score of an operator differs between bodies of the same shape that behave differently.
bool depends_on_behaviour(const Fitness& op, std::size_t score, std::uint64_t seed) {
  const auto of = [&](std::uint32_t input) {
    return op.score(sample_behaviour(op.observes(), seed, input).observation).at(score);
  };
  for (std::uint32_t input = 1; input < 5; ++input)
    if (of(input) != of(0)) return true;
  return false;
}

void honest_about_nan(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Fitness>(subject);
  const auto scores = op->score(unmeasurable_behaviour(op->observes()).observation);
  for (std::size_t i = 0; i < scores.size(); ++i)
    if (std::isfinite(scores[i]) && depends_on_behaviour(*op, i, seed))
      throw Violation("an observation in which everything measured is NaN scores " + to_text(scores[i]) +
                      "; expected a score that is not finite");
}

void scores_every_objective(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Fitness>(subject);
  const Request request = op->observes();
  if (!(request.settle >= 0) || !(request.window > 0))
    throw Violation("observes() gives settle = " + to_text(request.settle) +
                    " and window = " + to_text(request.window) + "; expected settle of at least 0 and window above 0");
  const auto objectives = op->objectives();
  const auto scores = op->score(sample_behaviour(request, seed, 0).observation);
  if (objectives.empty()) throw Violation("objectives() returns none; expected one or more");
  if (scores.size() != objectives.size())
    throw Violation("it gives " + std::to_string(scores.size()) + " scores for " + std::to_string(objectives.size()) +
                    " objectives");
  for (const Objective& objective : objectives)
    if (objective.name.empty() || objective.unit.empty())
      throw Violation("objectives() returns an objective without a name or a unit; the unit of a pure number is \"1\"");
  constexpr std::uint32_t bodies = 20;
  for (std::uint32_t input = 0; input < bodies; ++input)
    if (std::ranges::all_of(op->score(sample_behaviour(request, seed, input).observation),
                            [](double s) { return std::isfinite(s); }))
      return;
  throw Violation("none of " + std::to_string(bodies) + " bodies gets finite scores, so all would be invalid");
}

}  // namespace

std::vector<Case> laws_of(std::string_view kind) {
  if (kind == Encoding::kind) return {{"layout", layout_is_whole}, {"decoding", decodes}};
  if (kind == Mutation::kind)
    return {{"nothing", nothing_stays_nothing}, {"changes", mutates}, {"layout", mutants_fit}};
  if (kind == Crossover::kind) return {{"twins", twins_stay_twins}, {"changes", crosses}, {"layout", children_fit}};
  if (kind == Devo::kind) return {{"bodies", bodies_stay_sound}, {"locality", changes_stay_local}};
  if (kind == Fitness::kind)
    return {{"objectives", scores_every_objective}, {"translation", unmoved_by_translation}, {"nan", honest_about_nan}};
  return selection_laws();
}

}  // namespace evodevo::conformance
