// What a body has been through, as devo operators see it: the records of its masses, and what operators remember.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "evodevo/devo.hpp"
#include "experiment/experiment.hpp"
#include "life/body_building.hpp"

namespace evodevo {

struct LivingBody;

/// The records of a body's masses after a cycle, with one number for each mass. Lists that were not requested are
/// empty.
struct MassRecords {
  std::vector<double> contact;  ///< share of the cycle in which the mass touched the ground, 1
  std::vector<double> age;      ///< number of cycles that the mass has lived through, cycles
  std::vector<double> degree;   ///< number of springs at the mass when the cycle ended, 1
  std::vector<double> load;     ///< sum of the stress of its springs, in the unit of stress

  static constexpr std::array lists{&MassRecords::contact, &MassRecords::age, &MassRecords::degree, &MassRecords::load};
};

/// What an operator remembers about all masses, or about all springs.
struct ItemMemory {
  std::size_t width = 0;       ///< number of values for each item
  std::vector<double> values;  ///< [items][width]

  Memory view(const char* of) const { return {values, width, of}; }
};

/// What one devo operator remembers.
struct OperatorMemory {
  ItemMemory masses, springs;
  std::vector<double> body;
  bool springs_changed = false;  ///< whether the operator itself has changed what it remembers about springs
};

/// Returns what an operator that declares `names` remembers about a body at birth: what the encoding gave where the
/// names are equal, otherwise 0.
OperatorMemory memory_at_birth(const MemoryNames& names, const BuiltBody& built);

/// Replaces what an operator remembers by what its edits give. The values of new masses and springs come last; apply()
/// must follow. Throws a std::invalid_argument that names the place if the edits give the wrong number of values, or
/// one that is not finite, or give them to an item that does not exist. `names` are those that the operator declares.
void remember(const Edits& edits, const MemoryNames& names, const Body& body, OperatorMemory& memory);

/// Appends what is remembered about new springs: what is remembered about the spring that they are like, or 0. Does
/// nothing if it is there already. `springs` is the number of springs before.
void remember_new(const std::vector<NewSpring>& new_springs, std::size_t springs, ItemMemory& memory);

/// Lets a list with `width` values for each of `items` items follow an edit: keeps the values of the items that stay,
/// given by their indices, and then those of `added` new items. If the list has no values of the new items yet, they
/// are 0.
void follow(std::vector<double>& values, std::size_t width, std::size_t items,
            const std::vector<std::uint32_t>& staying, std::size_t added);

/// Makes the records of the masses that `request` asks for, at the end of a cycle. Contact is recorded during the
/// cycle.
void record_masses(const RecordRequest& request, LivingBody& living);

/// Makes only those records visible in an operator's context that the operator asked for.
void show_records(const LivingBody& records, const RecordRequest& request, DevoContext& context);

}  // namespace evodevo
