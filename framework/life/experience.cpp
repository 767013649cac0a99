#include "life/experience.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/text.hpp"
#include "life/edits.hpp"

namespace evodevo {
namespace {

/// Throws unless an operator that declares `names` gives a finite number for each of them. `item` is "mass", "spring"
/// or "body", and `whose` is such as "mass 3".
void check_values(std::span<const double> values, const std::vector<std::string>& names, const std::string& item,
                  const std::string& whose) {
  if (values.size() != names.size())
    throw std::invalid_argument("remembers " + std::to_string(values.size()) + " numbers about " + whose +
                                "; expected " + std::to_string(names.size()) + ", because " + item +
                                "_memory() declares as many names");
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      throw std::invalid_argument("remembers \"" + printable(names[i]) + "\" of " + whose + " as " +
                                  to_text(values[i]) + "; expected a finite number");
}

/// Replaces what an operator remembers about the `items` items that `edits` name, of which the last may be new.
void replace(const MemoryEdits& edits, const std::vector<std::string>& names, const std::string& item,
             std::size_t items, ItemMemory& memory) {
  auto from = edits.values.begin();
  for (std::size_t i = 0; i < edits.items.size(); ++i) {
    const std::string whose = item + ' ' + std::to_string(edits.items[i]);
    if (edits.items[i] >= items)
      throw std::invalid_argument("remembers something about " + whose + ", but there are only " +
                                  std::to_string(items) + ", numbered from 0");
    const auto count = static_cast<std::ptrdiff_t>(edits.counts[i]);
    check_values(std::span(from, from + count), names, item, whose);
    std::copy_n(from, count,
                memory.values.begin() + static_cast<std::ptrdiff_t>(std::size_t{edits.items[i]} * memory.width));
    from += count;
  }
}

/// Returns what is remembered at birth about `items` items under `names`.
ItemMemory at_birth(const std::vector<std::string>& names, const MemoryByName& given, std::size_t items) {
  const std::size_t width = names.size();
  ItemMemory memory{width, std::vector<double>(width * items, 0.0)};
  for (std::size_t name = 0; name < width; ++name) {
    const auto found = given.find(names[name]);
    if (found == given.end()) continue;
    for (std::size_t item = 0; item < items; ++item) memory.values[item * width + name] = found->second.at(item);
  }
  return memory;
}

}  // namespace

OperatorMemory memory_at_birth(const MemoryNames& names, const BuiltBody& built) {
  return {.masses = at_birth(names.masses, built.mass_memory, built.body.masses.size()),
          .springs = at_birth(names.springs, built.spring_memory, built.body.springs.size()),
          .body = std::vector<double>(names.body.size(), 0.0)};
}

void remember_new(const std::vector<NewSpring>& new_springs, std::size_t springs, ItemMemory& memory) {
  const std::size_t width = memory.width;
  if (width == 0 || new_springs.empty() || memory.values.size() > springs * width) return;
  memory.values.reserve(memory.values.size() + new_springs.size() * width);
  for (const NewSpring& spring : new_springs)
    for (std::size_t number = 0; number < width; ++number)
      memory.values.push_back(spring.like && *spring.like < springs ? memory.values[*spring.like * width + number]
                                                                    : 0.0);
}

void remember(const Edits& edits, const MemoryNames& names, const Body& body, OperatorMemory& memory) {
  if (!edits.mass_memory.items.empty()) {
    const std::size_t masses = body.masses.size() + edits.new_masses.size();
    memory.masses.values.resize(masses * memory.masses.width, 0.0);
    replace(edits.mass_memory, names.masses, "mass", masses, memory.masses);
  }
  if (!edits.spring_memory.items.empty()) {
    remember_new(edits.new_springs, body.springs.size(), memory.springs);
    replace(edits.spring_memory, names.springs, "spring", body.springs.size() + edits.new_springs.size(),
            memory.springs);
    memory.springs_changed = true;
  }
  if (edits.body_memory) {
    check_values(*edits.body_memory, names.body, "body", "the body");
    memory.body = *edits.body_memory;
  }
}

void follow(std::vector<double>& values, std::size_t width, std::size_t items,
            const std::vector<std::uint32_t>& staying, std::size_t added) {
  if (width == 0) return;  // most operators remember nothing
  values.resize((items + added) * width, 0.0);
  std::vector<double> kept;
  kept.reserve((staying.size() + added) * width);
  const auto keep = [&](std::size_t item) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(item * width);
    kept.insert(kept.end(), first, first + static_cast<std::ptrdiff_t>(width));
  };
  for (const std::uint32_t item : staying) keep(item);
  for (std::size_t item = 0; item < added; ++item) keep(items + item);
  values = std::move(kept);
}

void record_masses(const RecordRequest& request, LivingBody& living) {
  const std::vector<Spring>& springs = living.body.springs;
  const auto sum = [&](bool is_requested, const auto& of_spring) {
    std::vector<double> sums(is_requested ? living.body.masses.size() : 0, 0.0);
    for (std::size_t i = 0; is_requested && i < springs.size(); ++i)
      for (const std::uint32_t end : {springs[i].a, springs[i].b}) sums[end] += of_spring(i);
    return sums;
  };
  for (double& cycles : living.cycles_lived) ++cycles;
  living.age = request.age ? living.cycles_lived : std::vector<double>();
  living.degree = sum(request.degree, [](std::size_t) { return 1; });
  living.load = sum(request.load, [&](std::size_t spring) { return living.stress[spring]; });
}

void show_records(const LivingBody& records, const RecordRequest& request, DevoContext& context) {
  if (request.stress) context.stress.show(records.stress);
  if (request.peak_force) context.peak_force.show(records.peak_force);
  if (request.muscle_work) context.muscle_work.show(records.muscle_work);
  if (request.tension) context.tension.show(records.tension);
  if (request.contact) context.contact.show(records.contact);
  if (request.age) context.age.show(records.age);
  if (request.degree) context.degree.show(records.degree);
  if (request.load) context.load.show(records.load);
}

}  // namespace evodevo
