// A devo operator that reads a file.
#include <algorithm>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "evodevo/plugin.hpp"

namespace {

/// Removes springs by a plan: a text file that has, for each application of the operator, a line with the number of
/// springs to remove. Those with the least stress are removed. After the last line, nothing is removed.
class Plan final : public evodevo::Devo {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.file(plan_, "plan", "Text file with the number of springs to remove after each cycle, one in a line.");
    p.require(!plan_.path.empty(), "plan", "expected a file");
  }

  void prepare(const evodevo::EncodingContext&) override {
    std::istringstream lines(plan_.content);
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line.size() > 4 || line.find_first_not_of("0123456789") != line.npos)
        throw std::invalid_argument(plan_.path + ": line " + std::to_string(numbers_.size() + 1) + ": \"" + line +
                                    "\"; expected a whole number from 0 to 9999");
      numbers_.push_back(static_cast<std::uint32_t>(std::stoul(line)));
    }
  }

  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, evodevo::Rng&) const override {
    const auto line = static_cast<std::size_t>(context.application - 1);
    if (line >= numbers_.size()) return;
    std::vector<std::uint32_t> order(context.body.springs.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t i, std::uint32_t j) { return context.stress[i] < context.stress[j]; });
    order.resize(std::min<std::size_t>(order.size(), numbers_[line]));
    for (const std::uint32_t spring : order) edits.remove_spring(spring, {.cause = context.stress[spring]});
  }

 private:
  evodevo::InputFile plan_;
  std::vector<std::uint32_t> numbers_;  ///< of springs to remove, one for each application
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Plan>("outside.plan", "Removes as many springs as a file says."))
