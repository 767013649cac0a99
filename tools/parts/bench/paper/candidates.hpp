// Timing of the paper's methods.
#pragma once

#include <string>

#include "paper/paper_simulator.hpp"
#include "settings.hpp"

namespace evodevo::tools::bench {

/// Returns a description such as "springs shuffled, blocks of 256 threads".
std::string description(const PaperMethod& method);

/// A batch of copies of one body, simulated with one of the paper's methods. The body must outlive this object.
class TimedMethod {
 public:
  TimedMethod(const Settings& settings, const Body& body, const PaperMethod& method);

  /// Simulates the batch from birth once, and returns the spring evaluations per second. Throws std::runtime_error if
  /// the body diverges.
  double rate();

 private:
  PaperSimulator simulator_;
  std::uint64_t steps_;
};

struct Candidate {
  PaperMethod method;
  double rate = 0;     ///< spring evaluations per second of a single run
  unsigned tried = 0;  ///< number of methods among which it was the fastest
};

/// Tries all orders of springs with several block sizes, and returns the fastest combination.
Candidate fastest(const Settings& settings, const Body& body, MassMemory memory);

}  // namespace evodevo::tools::bench
