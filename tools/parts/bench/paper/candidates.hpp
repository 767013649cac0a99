// The paper's methods with the clock.
#pragma once

#include <string>

#include "paper/paper_simulator.hpp"
#include "settings.hpp"

namespace evodevo::tools::bench {

/// Such as "springs shuffled, blocks of 256 threads".
std::string description(const PaperMethod& method);

/// A batch of equal bodies with one of the paper's methods. The body must outlive it.
class TimedMethod {
 public:
  TimedMethod(const Settings& settings, const Body& body, const PaperMethod& method);

  /// Spring evaluations per second of one run from birth. Throws std::runtime_error where a body diverges.
  double rate();

 private:
  PaperSimulator simulator_;
  std::uint64_t steps_;
};

struct Candidate {
  PaperMethod method;
  double rate = 0;     ///< of a single run
  unsigned tried = 0;  ///< methods that it was chosen from
};

/// The fastest of all orders of springs and some sizes of a block.
Candidate fastest(const Settings& settings, const Body& body, MassMemory memory);

}  // namespace evodevo::tools::bench
