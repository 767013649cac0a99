// Plugins that load, but break one rule each, which a macro WRONG_... selects.
#include <unistd.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <csignal>
#include <ctime>
#include <numeric>
#include <random>

#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/memory.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Candidate;
using evodevo::Genome;
using evodevo::Layout;
using evodevo::Rng;

#if defined(WRONG_TWINS)

struct Wrong final : evodevo::Crossover {
  Genome cross(const evodevo::Parents&, const Layout& layout, Rng& rng) const override {
    return random_genome(layout, rng);
  }
};

#elif defined(WRONG_CHANGES_CROSSOVER)

struct Wrong final : evodevo::Crossover {
  Genome cross(const evodevo::Parents& parents, const Layout&, Rng&) const override { return parents.first; }
};

#elif defined(WRONG_CHANGES)

struct Wrong final : evodevo::Mutation {
  void mutate(Genome&, const Layout&, Rng&) const override {}
};

#elif defined(WRONG_DECODING) || defined(WRONG_DECODING_GROWTH) || defined(WRONG_DECODING_NOTHING)

struct Wrong final : evodevo::Encoding {
  Layout layout(const evodevo::EncodingContext&) const override {
    Layout layout;
    layout.add_block(2, {0, 1});
    return layout;
  }
  evodevo::Blueprint decode(const Genome&, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    evodevo::Blueprint blueprint;
#if defined(WRONG_DECODING_NOTHING)
    blueprint.failure = "never";
#endif
    blueprint.body.materials = context.materials;
    blueprint.body.masses = {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}};
#if defined(WRONG_DECODING)
    blueprint.body.springs = {{ 0, 2, 1, 1 }};  // there is no mass 2
#else
    blueprint.body.springs = {{ 0, 1, 1, 1, 1.5F }};
#endif
    return blueprint;
  }
};

#elif defined(WRONG_BODIES) || defined(WRONG_BODIES_DANGLING) || defined(WRONG_BODIES_NAN) || \
    defined(WRONG_BODIES_BEYOND) || defined(WRONG_BODIES_GROWTH) || defined(WRONG_BODIES_DESTROYED)

struct Wrong final : evodevo::Devo {
  void develop([[maybe_unused]] const evodevo::DevoContext& context, evodevo::Edits& edits, Rng&) const override {
#if defined(WRONG_BODIES)
    if (context.body.springs.empty()) return;
    const evodevo::Spring& twin = context.body.springs[0];
    edits.new_springs.push_back({twin.a, twin.b, context.body.materials[twin.material], {}});
#elif defined(WRONG_BODIES_DANGLING)
    const auto beyond = static_cast<std::uint32_t>(context.body.masses.size());
    edits.new_springs.push_back({0, beyond, {1000, 0, 0, 0}, {}});
#elif defined(WRONG_BODIES_NAN)
    edits.new_springs.push_back({0, 1, {std::nan(""), 0, 0, 0}, {}});
#elif defined(WRONG_BODIES_DESTROYED)
    for (std::uint32_t s = 0; s < context.body.springs.size(); ++s) edits.removed_springs.push_back(s);
#elif defined(WRONG_BODIES_GROWTH)
    edits.growth = {0, 1};
#else
    edits.new_masses.push_back({context.bounds.low - evodevo::Vec3{0, 0, 1}, context.mass});
#endif
  }
};

#elif defined(WRONG_BODIES_MEMORY)

struct Wrong final : evodevo::Devo {
  std::vector<std::string> mass_memory() const override { return {"calls"}; }
  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, Rng&) const override {
    edits.mass_memory.assign(context.body.masses.size() - 1, 1.0);
  }
};

#elif defined(WRONG_NAMES_MEASURE)

struct Wrong final : evodevo::Devo {
  evodevo::Measure measure(evodevo::Causes::List) const override { return {"<b>work</b>", "J"}; }
  void develop(const evodevo::DevoContext&, evodevo::Edits&, Rng&) const override {}
};

#elif defined(WRONG_DECODING_MEMORY)

struct Wrong final : evodevo::Encoding {
  Layout layout(const evodevo::EncodingContext&) const override {
    Layout layout;
    layout.add_block(2, {0, 1});
    return layout;
  }
  evodevo::Blueprint decode(const Genome&, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    evodevo::Blueprint blueprint;
    blueprint.body.materials = context.materials;
    blueprint.body.masses = {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}};
    blueprint.body.springs = {{0, 1, 1, 1}};
    blueprint.mass_memory["stem"] = {1, 2, 3};
    return blueprint;
  }
};

#elif defined(WRONG_TRANSLATION) || defined(WRONG_NAN_HIDDEN) || defined(WRONG_OBJECTIVES) || \
    defined(WRONG_OBJECTIVES_NAN) || defined(WRONG_NAMES_OBJECTIVE) || defined(WRONG_NAMES_UNIT)

struct Wrong final : evodevo::Fitness {
  evodevo::Request observes() const override { return {0, 0.1, false}; }
#if defined(WRONG_NAMES_OBJECTIVE)
  static constexpr const char *name = "<b>way</b>", *unit = "m";
#elif defined(WRONG_NAMES_UNIT)
  static constexpr const char *name = "way", *unit = "m\n";
#else
  static constexpr const char *name = "way", *unit = "m";
#endif
  std::vector<evodevo::Objective> objectives() const override { return {{name, unit, true}}; }
  std::vector<double> score(const evodevo::Observation& seen) const override {
    const double way = seen.centre_after.x - seen.centre_before.x;
#if defined(WRONG_TRANSLATION)
    return {way + seen.centre_after.x};
#elif defined(WRONG_NAN_HIDDEN)
    return {std::isnan(way) ? 0 : way};
#elif defined(WRONG_OBJECTIVES_NAN)
    return {-std::nan("") * way};
#elif defined(WRONG_OBJECTIVES)
    return {way, way};
#else
    return {way};
#endif
  }
};

#elif defined(WRONG_GENERATIONS) || defined(WRONG_GENERATIONS_NOTE) || defined(WRONG_GENERATIONS_CHILDREN)

struct Wrong final : evodevo::Selection {
  evodevo::Traits traits() const override { return {.is_elitist = false, .makes_children = true}; }
  std::vector<evodevo::NoteTitle> notes() const override { return {{"share"}}; }
  std::vector<evodevo::Child> children(const evodevo::SelectionContext& context, std::uint32_t count,
                                       Rng& rng) const override {
    std::vector<evodevo::Child> children;
    for (std::uint32_t i = 0; i < count; ++i) children.push_back({random_genome(context.layout, rng)});
#if defined(WRONG_GENERATIONS_CHILDREN)
    if (context.rows.empty()) children.front().genome.genes.front() = 1000;  // in the first generation alone
#endif
    return children;
  }
  evodevo::Survival survive([[maybe_unused]] const evodevo::SelectionContext& context, std::uint32_t,
                            Rng&) const override {
    evodevo::Survival survival{{0}};
#if defined(WRONG_GENERATIONS)
    static int calls = 0;
    survival.memory = {std::byte(++calls)};
#elif defined(WRONG_GENERATIONS_NOTE)
    const double failed = std::count_if(context.rows.begin(), context.rows.end(), [](auto& row) { return !row.ok(); });
    survival.notes = {{ 0, 0, 1 / failed }};  // if none failed, no number
#endif
    return survival;
  }
};

#elif defined(WRONG_ORDER_MEMORY) || defined(WRONG_GENERATIONS_MEMORY)

/// The best survive, and all children are equal to the individual that was born last.
struct Wrong final : evodevo::Selection {
  evodevo::Traits traits() const override {
#if defined(WRONG_ORDER_MEMORY)
    return {.makes_children = true, .needs_real_genes = true, .needs_memory = true};
#else
    return {.makes_children = true, .needs_real_genes = true};
#endif
  }
  std::vector<evodevo::Child> children(const evodevo::SelectionContext& context, std::uint32_t count,
                                       Rng& rng) const override {
    if (context.memory.empty()) return std::vector<evodevo::Child>(count, {random_genome(context.layout, rng)});
    Genome genome(context.layout.first_size());
    genome.genes = evodevo::MemoryReader(context.memory).read_list<float>();
    return std::vector<evodevo::Child>(count, {genome});
  }
  evodevo::Survival survive(const evodevo::SelectionContext& context, std::uint32_t population, Rng&) const override {
    evodevo::MemoryWriter writer;
    writer.write(context.rows.back().genome->genes);
    return {evodevo::first_rows(evodevo::best_first(context.rows), population), writer.bytes()};
  }
};

#elif defined(WRONG_ORDER) || defined(WRONG_ELITE) || defined(WRONG_FAILED)

struct Wrong final : evodevo::Selection {
  static std::vector<std::uint32_t> best_first(std::span<const Candidate> rows) {
    std::vector<std::uint32_t> order(rows.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
#if defined(WRONG_FAILED)
      if (rows[i].ok() != rows[j].ok()) return rows[j].ok();
#else
      if (rows[i].ok() != rows[j].ok()) return rows[i].ok();
#endif
      return rows[i].ok() && rows[i].scores[0] > rows[j].scores[0];
    });
#if defined(WRONG_ORDER)
    std::sort(order.begin(), order.end(),
              [&](auto i, auto j) { return rows[i].ok() != rows[j].ok() ? rows[i].ok() : i < j; });
#elif defined(WRONG_ELITE)
    if (order.size() > 1) order.erase(order.begin());
#endif
    return order;
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t> > parents(std::span<const Candidate> rows, std::uint32_t count,
                                                                Rng&) const override {
    const std::uint32_t best = best_first(rows).front();
    return {count, {best, best}};
  }
  std::vector<std::uint32_t> survivors(std::span<const Candidate> rows, std::uint32_t population, Rng&) const override {
    auto order = best_first(rows);
    order.resize(std::min<std::size_t>(order.size(), population));
    return order;
  }
};

#else

#if defined(WRONG_LISTING)
[[maybe_unused]] const bool slow = [] {
  while (std::clock() < CLOCKS_PER_SEC / 5) {
  }
  return true;
}();
#endif

thread_local bool made_here = false;
int calls_in_this_process = 0;

struct Wrong final : evodevo::Mutation {
  Wrong() { made_here = true; }

#if defined(WRONG_INSTANCES)
  static inline std::int64_t genes_ = 1;
#else
  std::int64_t genes_ = 1;
#endif
  mutable int calls_ = 0;

#if defined(WRONG_INSTANCES_PREPARED)
  static inline float prepared_ = 0;  // what prepare() computes, of all instances
  void prepare(const evodevo::EncodingContext&) override { prepared_ = 0.1F * static_cast<float>(genes_); }
#endif

  void parameters(evodevo::Parameters& p) override {
#if defined(WRONG_DECLARATIONS)
    p.integer(genes_, "genes", {0, 5, "1"}, "");
#elif defined(WRONG_NAMES)
    p.integer(genes_, "genes", {0, 5, "1"}, "Genes that change <script>alert(1)</script>.");
#elif defined(WRONG_NAMES_CONTROL)
    p.integer(genes_, "ge\nnes", {0, 5, "1"}, "Genes that change.");
#elif defined(WRONG_REFUSALS)
    try {
      p.integer(genes_, "genes", {0, 5, "1"}, "Genes that change.");
    } catch (const std::exception&) {
    }
#else
    p.integer(genes_, "genes", {0, 5, "1"}, "Genes that change.");
#endif
  }

  void mutate(Genome& genome, const Layout& layout, [[maybe_unused]] Rng& rng) const override {
    ++calls_;
    ++calls_in_this_process;
#if defined(WRONG_NOTHING)
    if (genome.empty()) return genome.genes.push_back(1);
#endif
#if defined(WRONG_ENDLESS)
    while (genome.empty()) pause();
#endif
    if (genome.empty()) return;
    float& gene = genome[0];
    const evodevo::GeneSpec& spec = layout.gene(genome, 0);
    gene = spec.draw(rng);
#if defined(WRONG_SAME_SEED)
    gene = static_cast<float>(std::random_device()() % 1000) / 1000;
#elif defined(WRONG_THREADS)
    if (!made_here) gene = spec.low;
#elif defined(WRONG_BATCH)
    if (calls_ > 3) gene = spec.low;
#elif defined(WRONG_INPUTS)
    const_cast<evodevo::GeneSpec&>(spec).high *= 0.5F;
#elif defined(WRONG_RESUMING)
    if (calls_in_this_process > 5) gene = spec.draw(rng);
#elif defined(WRONG_LAYOUT)
    gene = spec.high + 1;
#elif defined(WRONG_INSTANCES_PREPARED)
    gene = spec.is_real() ? spec.low + (spec.high - spec.low) * prepared_ : 0;
#elif defined(WRONG_CRASHING)
    std::raise(SIGSEGV);
#elif defined(WRONG_HIDDEN_STATE)
    if (calls_in_this_process > 100) gene = spec.low;
#elif defined(WRONG_SURROUNDINGS)
    std::setlocale(LC_ALL, "C.UTF-8");
#endif
  }
};

#endif

}  // namespace

#if defined(WRONG_EXPORTS)
extern "C" __attribute__((visibility("default"), weak)) int another_export() { return 1; }  // as if inline
#endif

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Wrong>("wrong", "Breaks one rule."))
