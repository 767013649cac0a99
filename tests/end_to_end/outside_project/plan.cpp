// A devo operator that reads a file.
#include <algorithm>
#include <numeric>
#include <optional>
#include <sstream>

#include "evodevo/plugin.hpp"

namespace {

/// Removes springs by a plan: a text file that has, for each application of the operator, a line with the number of
/// springs to remove. Those with the least stress are removed. After the last line, nothing is removed.
class Plan final : public evodevo::Devo {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.file(plan_, "plan", "Text file with the number of springs to remove after each cycle, one in a line.");
    p.require(!plan_.path.empty(), "plan", "expected a file");
    p.require(numbers().has_value(), "plan", "expected a file with a whole number from 0 to 1000 in each line");
  }

  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, evodevo::Rng&) const override {
    const std::vector<std::uint32_t> plan = numbers().value_or(std::vector<std::uint32_t>{});
    const auto line = static_cast<std::size_t>(context.application - 1);
    if (line >= plan.size()) return;
    std::vector<std::uint32_t> order(context.body.springs.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t i, std::uint32_t j) { return context.stress[i] < context.stress[j]; });
    order.resize(std::min<std::size_t>(order.size(), plan[line]));
    for (const std::uint32_t spring : order) edits.causes.removed_springs.push_back(context.stress[spring]);
    edits.removed_springs = std::move(order);
  }

 private:
  /// Returns the numbers in the file, or nothing if a line is something else.
  std::optional<std::vector<std::uint32_t>> numbers() const {
    std::vector<std::uint32_t> found;
    std::istringstream lines(plan_.content);
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line.size() > 4 || line.find_first_not_of("0123456789") != line.npos) return std::nullopt;
      found.push_back(static_cast<std::uint32_t>(std::stoul(line)));
      if (found.back() > 1000) return std::nullopt;
    }
    return found;
  }

  evodevo::InputFile plan_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Plan>("outside.plan", "Removes as many springs as a file says."))
