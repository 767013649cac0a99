// The record of a life, as the archive holds it.
#include "life/life_record.hpp"

#include <stdexcept>

#include "fuzz/target.hpp"

namespace evodevo {

void fuzz(std::string_view input) {
  try {
    const LifeRecord record{std::string(input)};
    LifeRecord again;
    for (const Change& change : record.changes()) again.add(change);
    LifeRecord twice;
    for (const Change& change : again.changes()) twice.add(change);
    require(twice == again, "the record of a life that was written reads back as another one");
  } catch (const std::invalid_argument&) {
  }
}

}  // namespace evodevo
