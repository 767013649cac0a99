// Development by regulation: the same small network runs in every mass of the body, as the same genes run in every cell
// of an animal, and what a mass feels decides what it does. The weights are genes, so that the rule of development
// evolves together with the bodies.
#include <cmath>
#include <numeric>

#include "evodevo/plugin.hpp"
#include "mass_acts.hpp"

namespace {

using evodevo::Body;
using evodevo::DevoContext;
using evodevo::Edits;
using evodevo::Parameters;
using evodevo::Rng;
using evodevo::Spring;
using evodevo::Table;

/// What a mass feels, in the order of the network's inputs. The inputs after these are what the mass remembers.
enum Feeling : std::size_t { bias, load, contact, age, degree, neighbours, feelings };
constexpr std::array<const char*, feelings> feeling_names = {"bias", "load", "contact", "age", "degree", "neighbours"};

double finite(double value) { return std::isfinite(value) ? value : 0; }

/// Returns the mean magnitude of numbers. It does not depend on their order, not even in the last bit.
double mean_magnitude(std::span<const double> values) {
  std::vector<double> magnitudes;
  for (const double value : values) magnitudes.push_back(std::abs(finite(value)));
  std::sort(magnitudes.begin(), magnitudes.end());
  const double sum = std::accumulate(magnitudes.begin(), magnitudes.end(), 0.0);
  return magnitudes.empty() ? 0 : sum / static_cast<double>(magnitudes.size());
}

/// Returns the inputs of the network in every mass.
Table inputs(const DevoContext& context, const evodevo::ActLimits& limits) {
  const Body& body = context.body;
  const std::size_t masses = body.masses.size(), memory = context.mass_memory.width();
  Table in(masses, feelings + memory);
  const double mean_load = mean_magnitude(context.load);
  std::vector<double> springs(masses);
  for (const Spring& spring : body.springs)
    for (const auto& [mass, other] : {std::pair(spring.a, spring.b), {spring.b, spring.a}}) {
      in.at(mass, neighbours) += context.mass_memory[other][0];
      ++springs[mass];
    }
  for (std::size_t i = 0; i < masses; ++i) {
    in.at(i, bias) = 1;
    in.at(i, load) = mean_load > 0 ? finite(context.load[i]) / mean_load : 0;
    in.at(i, contact) = finite(context.contact[i]);
    in.at(i, age) = finite(context.age[i]) / context.cycles;
    in.at(i, degree) = finite(context.degree[i]) / static_cast<double>(limits.most_springs);
    in.at(i, neighbours) /= std::max(springs[i], 1.0);
    for (std::size_t m = 0; m < memory; ++m) in.at(i, feelings + m) = context.mass_memory[i][m];
  }
  return in;
}

/// Returns the outputs of the network in every mass: tanh of the weighted sums of its inputs. `weights` has those of
/// the first output, then those of the second, and so on.
Table outputs(const Table& in, std::size_t masses, const evodevo::Genome& weights) {
  Table out(masses, weights.size() / in.columns());
  for (std::size_t i = 0; i < masses; ++i)
    for (std::size_t o = 0; o < out.columns(); ++o) {
      double sum = 0;
      for (std::size_t n = 0; n < in.columns(); ++n)
        sum += static_cast<double>(weights[o * in.columns() + n]) * in.at(i, n);
      out.at(i, o) = std::tanh(sum);
    }
  return out;
}

/// In every mass, out = tanh(W in), where the weights W are genes: a network like that of the genes of a cell (Wagner
/// 1996, "Does evolutionary plasticity evolve?").
///
///   in:  1; load relative to the body's mean; contact; age, 1 at the end of the development; number of springs
///        relative to `most_springs`; mean signal of the masses that it is joined to; signal; what else it remembers
///   out: divide; stiffen or soften; let go; reach; new signal; what else it remembers from now on
///
/// A mass acts if the output is positive, and stiffens its springs by it or, if it is negative, softens them. All
/// masses feel the signals of the cycle before, so that a signal spreads from mass to mass by one spring per
/// application, like a morphogen (Turing 1952, "The chemical basis of morphogenesis").
class RegulatedGrowth final : public evodevo::Devo {
 public:
  void parameters(Parameters& p) override {
    p.integer(memory_, "memory", {1, 16, "1"},
              "Number of numbers that a mass remembers. The first is its signal, which its neighbours feel.");
    limits_.declare(p);
  }

  evodevo::RecordRequest observes() const override {
    return {.stress = true, .contact = true, .age = true, .degree = true, .load = true};
  }
  evodevo::Measure measure(evodevo::EditKind) const override { return {"output", "1"}; }

  std::vector<std::string> mass_memory() const override {
    std::vector<std::string> names = {"signal"};
    for (std::int64_t i = 1; i < memory_; ++i) names.push_back("memory " + std::to_string(i));
    return names;
  }

  /// One block for each output, with one gene for each input.
  evodevo::Layout layout(const evodevo::EncodingContext&) const override {
    const std::vector<std::string> memory = mass_memory();
    std::vector<std::string> in(feeling_names.begin(), feeling_names.end()),
        out(evodevo::action_names.begin(), evodevo::action_names.end());
    in.insert(in.end(), memory.begin(), memory.end());
    out.insert(out.end(), memory.begin(), memory.end());
    evodevo::Layout own;
    for (const std::string& name : out) {
      own.add_block(static_cast<std::uint32_t>(in.size()), {-3, 3}, name);
      own.types.back().gene_names = in;
    }
    return own;
  }

  void develop(const DevoContext& context, Edits& edits, Rng& rng) const override {
    const std::size_t masses = context.body.masses.size();
    const Table out = outputs(inputs(context, limits_), masses, context.own);
    for (std::uint32_t i = 0; i < masses; ++i) edits.remember_mass(i, out.row(i).subspan(evodevo::actions));
    evodevo::MassActs acts(limits_, context, out, edits);
    acts.let_springs_go();
    acts.reach_for_others();
    evodevo::Chance chance(context, rng);
    acts.divide_masses(chance);
    acts.change_stiffness();
  }

 private:
  std::int64_t memory_ = 2;
  evodevo::ActLimits limits_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<RegulatedGrowth>("regulated-growth",
                                                        "Runs a small network in every mass, whose weights are genes: "
                                                        "what a mass feels decides whether it divides, stiffens or "
                                                        "softens its springs, lets one go, or reaches for another."))
