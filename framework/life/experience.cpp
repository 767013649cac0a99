#include "life/experience.hpp"

#include <cmath>
#include <stdexcept>

#include "base/text.hpp"
#include "life/edits.hpp"

namespace evodevo {
namespace {

/// Replaces what an operator remembers about the items of a body by `values`, which are also those of new items. `item`
/// is "mass" or "spring".
void replace(const std::vector<double>& values, const std::vector<std::string>& names, const std::string& item,
             std::size_t items, std::size_t added, ItemMemory& memory) {
  if (values.empty()) return;
  const std::string list = "Edits::" + item + "_memory";
  const std::size_t width = memory.width;
  if (values.size() != (items + added) * width)
    throw std::invalid_argument("gives " + std::to_string(values.size()) + " numbers in " + list + " for " +
                                std::to_string(items) + " " + item + (item == "mass" ? "es" : "s") + " and " +
                                std::to_string(added) + " new ones; expected " +
                                std::to_string((items + added) * width) + ", because " + item + "_memory() declares " +
                                std::to_string(width) + " for each");
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      throw std::invalid_argument("gives \"" + printable(names.at(i % width)) + "\" of " + item + " " +
                                  std::to_string(i / width) + " in " + list + " the value " + to_text(values[i]) +
                                  "; expected a finite number");
  memory.values = values;
}

}  // namespace

OperatorMemory memory_at_birth(const MemoryNames& names, const MemoryByName& given, const Body& body) {
  const auto blank = [](std::size_t width, std::size_t items) {
    return ItemMemory{width, std::vector<double>(width * items, 0.0)};
  };
  const std::size_t width = names.masses.size();
  OperatorMemory memory{blank(width, body.masses.size()), blank(names.springs.size(), body.springs.size())};
  for (std::size_t name = 0; name < width; ++name) {
    const auto found = given.find(names.masses[name]);
    if (found == given.end()) continue;
    for (std::size_t mass = 0; mass < body.masses.size(); ++mass)
      memory.masses.values[mass * width + name] = found->second.at(mass);
  }
  return memory;
}

void remember(const Edits& edits, const MemoryNames& names, const Body& body, OperatorMemory& memory) {
  replace(edits.mass_memory, names.masses, "mass", body.masses.size(), edits.new_masses.size(), memory.masses);
  replace(edits.spring_memory, names.springs, "spring", body.springs.size(), edits.new_springs.size(), memory.springs);
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
