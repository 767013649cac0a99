// Plugins that load, but break one rule each, which the macro FAULT names.
#include <unistd.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <csignal>
#include <ctime>
#include <numeric>
#include <random>
#include <string_view>

#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/memory.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Candidate;
using evodevo::Genome;
using evodevo::Layout;
using evodevo::Rng;
using evodevo::VariationContext;

constexpr std::string_view fault = FAULT;

struct Crossover final : evodevo::Crossover {
  Genome cross(const evodevo::Parents& parents, const VariationContext& context, Rng& rng) const override {
    return fault == "twins" ? random_genome(context.layout, rng) : parents.first;
  }
};

struct Encoding final : evodevo::Encoding {
  Layout layout(const evodevo::EncodingContext&) const override {
    Layout layout;
    layout.add_block(2, {0, 1});
    return layout;
  }
  evodevo::Blueprint decode(const Genome&, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    evodevo::Blueprint blueprint;
    if constexpr (fault == "decoding_nothing") blueprint.failure = "never";
    blueprint.body.materials = context.materials;
    blueprint.body.masses = {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}};
    blueprint.body.springs = {{0, fault == "decoding" ? 2u : 1u, 1, 1}};  // there is no mass 2
    if constexpr (fault == "decoding_springs") blueprint.spring_memory["stem"] = {1};
    if constexpr (fault == "decoding_memory") blueprint.mass_memory["stem"] = {1, 2, 3};
    return blueprint;
  }
};

struct Devo final : evodevo::Devo {
  std::vector<std::string> mass_memory() const override {
    if constexpr (fault == "bodies_memory") return {"calls"};
    return {};
  }
  evodevo::Traits traits() const override {
    if constexpr (fault == "locality") return {.locality = 3};
    return {};
  }
  evodevo::Measure measure(evodevo::EditKind edit) const override {
    if constexpr (fault == "names_measure") return {"<b>work</b>", "J"};
    return evodevo::Devo::measure(edit);
  }
  void develop([[maybe_unused]] const evodevo::DevoContext& context, [[maybe_unused]] evodevo::Edits& edits,
               [[maybe_unused]] Rng& rng) const override {
    if constexpr (fault == "locality") {
      for (std::uint32_t s = 0; s < context.body.springs.size(); ++s)  // one mass less, and all later draws differ
        if (rng.chance(0.1)) edits.remove_spring(s);
    } else if constexpr (fault == "bodies") {
      if (context.body.springs.empty()) return;
      const evodevo::Spring& twin = context.body.springs[0];
      edits.join(twin.a, twin.b, context.body.materials[twin.material]);
    } else if constexpr (fault == "bodies_dangling") {
      const auto beyond = static_cast<std::uint32_t>(context.body.masses.size());
      edits.join(0, beyond, {1000, 0, 0, 0});
    } else if constexpr (fault == "bodies_nan") {
      edits.join(0, 1, {std::nan(""), 0, 0, 0});
    } else if constexpr (fault == "bodies_destroyed") {
      for (std::uint32_t s = 0; s < context.body.springs.size(); ++s) edits.remove_spring(s);
    } else if constexpr (fault == "bodies_scaling") {
      edits.scale_lengths({.to = 1});
    } else if constexpr (fault == "bodies_beyond") {
      edits.add_mass(context.bounds.low - evodevo::Vec3{0, 0, 1});
    } else if constexpr (fault == "bodies_memory") {
      edits.remember_mass(1, {1.0, 2.0});
    }
  }
};

struct Fitness final : evodevo::Fitness {
  evodevo::Request observes() const override { return {0, 0.1, false}; }
  std::vector<evodevo::Objective> objectives() const override {
    return {{fault == "names_objective" ? "<b>way</b>" : "way", fault == "names_unit" ? "m\n" : "m", true}};
  }
  std::vector<double> score(const evodevo::Observation& seen) const override {
    const double way = seen.centre_after.x - seen.centre_before.x;
    if constexpr (fault == "translation") return {way + seen.centre_after.x};
    if constexpr (fault == "nan_hidden") return {std::isnan(way) ? 0 : way};
    if constexpr (fault == "objectives_nan") return {-std::nan("") * way};
    if constexpr (fault == "objectives") return {way, way};
    return {way};
  }
};

struct Generations final : evodevo::Selection {
  evodevo::Traits traits() const override { return {.is_elitist = false}; }
  std::vector<evodevo::NoteTitle> notes() const override { return {{"share"}}; }
  std::vector<std::string> memory() const override { return {"calls"}; }
  evodevo::Offspring children(const evodevo::SelectionContext& context, std::uint32_t count, Rng& rng) const override {
    std::vector<evodevo::Child> children;
    for (std::uint32_t i = 0; i < count; ++i) children.push_back({random_genome(context.layout, rng)});
    if (fault == "generations_children" && context.rows.empty())
      children.front().genome.genes.front() = 1000;  // in the first generation alone
    if (fault == "generations_child" && context.rows.empty()) children.back().notes = {{1, 0.5}};
    return children;
  }
  evodevo::Survival survivors(const evodevo::SelectionContext& context, std::uint32_t, Rng&) const override {
    const auto eldest = std::ranges::min_element(context.rows, {}, &Candidate::id);
    evodevo::Survival survival = std::vector{static_cast<std::uint32_t>(eldest - context.rows.begin())};
    static int calls = 0;
    if (fault == "generations") survival.memory = evodevo::SelectionMemory{.lists = {{"calls", {double(++calls)}}}};
    const double failed = std::count_if(context.rows.begin(), context.rows.end(), [](auto& row) { return !row.ok(); });
    if (fault == "generations_note") survival.notes = {{survival.rows[0], 0, 1 / failed}};  // if none failed, no number
    return survival;
  }
};

/// The best survive, and all children are equal to the individual that was born last.
struct Remembering final : evodevo::Selection {
  evodevo::Traits traits() const override { return {.needs_real_genes = true}; }
  std::vector<std::string> memory() const override { return {fault == "generations_memory" ? "proteins" : "genes"}; }
  evodevo::Offspring children(const evodevo::SelectionContext& context, std::uint32_t count, Rng& rng) const override {
    if (context.memory.empty()) return std::vector<evodevo::Child>(count, {random_genome(context.layout, rng)});
    Genome genome(context.layout.first_size());
    std::ranges::copy(context.memory.list("genes"), genome.begin());
    return std::vector<evodevo::Child>(count, {genome});
  }
  evodevo::Survival survivors(const evodevo::SelectionContext& context, std::uint32_t population, Rng&) const override {
    evodevo::Survival survival = evodevo::first_rows(evodevo::best_first(context.rows), population);
    const std::vector<float>& genes = context.rows.back().genome->genes;
    survival.memory = evodevo::SelectionMemory{.lists = {{"genes", {genes.begin(), genes.end()}}}};
    return survival;
  }
};

struct Selection final : evodevo::Selection {
  static std::vector<std::uint32_t> best_first(std::span<const Candidate> rows) {
    std::vector<std::uint32_t> order(rows.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
      if (rows[i].ok() != rows[j].ok()) return rows[fault == "failed" ? j : i].ok();
      if (rows[i].ok() && rows[i].scores[0] != rows[j].scores[0]) return rows[i].scores[0] > rows[j].scores[0];
      return fault != "order_ties" && rows[i].id < rows[j].id;
    });
    if (fault == "order")
      std::sort(order.begin(), order.end(),
                [&](auto i, auto j) { return rows[i].ok() != rows[j].ok() ? rows[i].ok() : i < j; });
    if (fault == "elite" && order.size() > 1) order.erase(order.begin());
    return order;
  }
  std::vector<evodevo::Couple> parents(const evodevo::SelectionContext& context, std::uint32_t count,
                                       Rng&) const override {
    const std::uint32_t best = best_first(context.rows).front();
    return {count, {best, best}};
  }
  evodevo::Survival survivors(const evodevo::SelectionContext& context, std::uint32_t population, Rng&) const override {
    return evodevo::first_rows(best_first(context.rows), population);
  }
};

[[maybe_unused]] const bool slow = [] {
  while (fault == "listing" && std::clock() < CLOCKS_PER_SEC / 5) {
  }
  return true;
}();

thread_local bool made_here = false;
int calls_in_this_process = 0;

struct Mutation final : evodevo::Mutation {
  Mutation() { made_here = true; }

  static inline std::int64_t genes_of_all_ = 1;
  std::int64_t genes_ = 1;
  mutable int calls_ = 0;
  static inline float prepared_ = 0;  // what prepare() computes, of all instances

  void prepare(const evodevo::EncodingContext&) override {
    if constexpr (fault == "instances_prepared") prepared_ = 0.1F * static_cast<float>(genes_);
  }
  void parameters(evodevo::Parameters& p) override {
    const char* help = "Genes that change.";
    if constexpr (fault == "declarations") help = "";
    if constexpr (fault == "names") help = "Genes that change <script>alert(1)</script>.";
    try {
      p.integer(fault == "instances" ? genes_of_all_ : genes_, fault == "names_control" ? "ge\nnes" : "genes",
                {0, 5, "1"}, help);
    } catch (const std::exception&) {
      if constexpr (fault != "refusals") throw;
    }
  }
  void mutate([[maybe_unused]] Genome& genome, [[maybe_unused]] const VariationContext& context,
              [[maybe_unused]] Rng& rng) const override {
    if constexpr (fault == "changes") return;
    ++calls_;
    ++calls_in_this_process;
    if constexpr (fault == "nothing") {
      if (genome.empty()) return genome.genes.push_back(1);
    }
    if constexpr (fault == "endless") {
      while (genome.empty()) pause();
    }
    if (genome.empty()) return;
    float& gene = genome[0];
    const evodevo::GeneSpec& spec = context.layout.gene(genome, 0);
    gene = spec.draw(rng);
    if constexpr (fault == "same_seed") gene = static_cast<float>(std::random_device()() % 1000) / 1000;
    if (fault == "threads" && !made_here) gene = spec.low;
    if (fault == "batch" && calls_ > 3) gene = spec.low;
    if constexpr (fault == "inputs") const_cast<evodevo::GeneSpec&>(spec).high *= 0.5F;
    if (fault == "resuming" && calls_in_this_process > 5) gene = spec.draw(rng);
    if constexpr (fault == "layout") gene = spec.high + 1;
    if constexpr (fault == "instances_prepared")
      gene = spec.is_real() ? spec.low + (spec.high - spec.low) * prepared_ : 0;
    if constexpr (fault == "crashing") std::raise(SIGSEGV);
    if (fault == "hidden_state" && calls_in_this_process > 100) gene = spec.low;
    if constexpr (fault == "surroundings") std::setlocale(LC_ALL, "C.UTF-8");
  }
};

/// Returns the operator of the kind whose rule is broken.
constexpr evodevo::OperatorEntry wrong() {
  using evodevo::operator_entry;
  constexpr const char *name = "wrong", *summary = "Breaks one rule.";
  const auto is_one_of = [](auto... faults) { return ((fault == faults) || ...); };
  if constexpr (is_one_of("twins", "changes_crossover")) return operator_entry<Crossover>(name, summary);
  if constexpr (fault.starts_with("decoding")) return operator_entry<Encoding>(name, summary);
  if constexpr (fault.starts_with("bodies") || is_one_of("locality", "names_measure"))
    return operator_entry<Devo>(name, summary);
  if constexpr (is_one_of("translation", "nan_hidden", "objectives", "objectives_nan", "names_objective", "names_unit"))
    return operator_entry<Fitness>(name, summary);
  if constexpr (is_one_of("generations", "generations_note", "generations_children", "generations_child"))
    return operator_entry<Generations>(name, summary);
  if constexpr (is_one_of("order_memory", "generations_memory")) return operator_entry<Remembering>(name, summary);
  if constexpr (is_one_of("order", "order_ties", "elite", "failed")) return operator_entry<Selection>(name, summary);
  return operator_entry<Mutation>(name, summary);
}

}  // namespace

/// Hidden unless the library lacks the version script that every plugin has.
extern "C" __attribute__((visibility("default"), weak)) int another_export() { return 1; }  // as if inline

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE, wrong())
