// Writes generations into an archive. If that takes long, the next one is bred and evaluated meanwhile.
#pragma once

#include <future>

#include "archive/archive.hpp"

namespace evodevo {

/// Writes one generation at a time. If writing the one before took more than 0.1 s, and more than a tenth of the time
/// of this one, it writes on a thread of its own. Until that ends, a crash or `kill -9` loses this generation, whose
/// evaluation has taken less than ten times as long as that writing; so generations that take long are not at risk.
/// Between begin() and wait(), nobody else may use the archive, which must outlive this object. The destructor waits as
/// well, but does not throw.
class ArchiveWriter {
 public:
  explicit ArchiveWriter(Archive& archive) : archive_(archive) {}

  /// Waits for the generation before, then writes this one or begins to. Throws what wait() throws.
  void begin(FinishedGeneration generation);
  /// Waits until everything has been committed. Throws what Archive::commit() has thrown.
  void wait();
  /// The time that commits have taken until the last wait, s.
  double seconds() const { return seconds_; }

 private:
  Archive& archive_;
  std::future<double> under_way_;  ///< the time that the commit takes, s
  double last_ = 0, seconds_ = 0;
};

}  // namespace evodevo
