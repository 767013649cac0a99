// The functions of Archive that read and write what was measured of a run.
#include "archive/archive.hpp"
#include "archive/database.hpp"

namespace evodevo {

bool Archive::set_signal(const std::vector<SignalNumber>& numbers, std::uint32_t generation) {
  WriteTransaction transaction(*run_);
  Statement later(*run_, "generations", "SELECT 1 FROM generations WHERE generation > ?");
  later.bind(generation);
  if (later.step()) return false;
  run_->execute("DELETE FROM signal");
  Statement insert(*run_, "signal", "INSERT INTO signal VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)");
  std::uint32_t position = 0;
  for (const SignalNumber& number : numbers)
    insert.execute(position++, number.population, number.quantity, number.of, number.scale, number.value, number.low,
                   number.high, number.count);
  transaction.commit();
  return true;
}

std::vector<SignalNumber> Archive::signal() const {
  Statement row(*run_, "signal",
                "SELECT population, quantity, of, scale, value, low, high, count FROM signal ORDER BY position");
  std::vector<SignalNumber> numbers;
  while (row.step())
    numbers.push_back({row.line(0), row.line(1), row.line(2), row.line(3), row.number(4), row.optional_number(5),
                       row.optional_number(6), row.integer(7, 0, std::numeric_limits<std::int64_t>::max())});
  return numbers;
}

}  // namespace evodevo
