// Measures the time during which at least one thread was busy with a certain kind of work.
#pragma once

#include <chrono>
#include <mutex>

namespace evodevo {

/// Measures the time during which at least one Span exists. Spans of several threads may overlap.
class BusyClock {
 public:
  class Span {
   public:
    explicit Span(BusyClock& clock) : clock_(clock) { clock_.open(); }
    Span(const Span&) = delete;
    Span& operator=(const Span&) = delete;
    ~Span() { clock_.close(); }

   private:
    BusyClock& clock_;
  };

  /// The time covered by spans so far, s.
  double seconds() const {
    const std::lock_guard lock(mutex_);
    const auto now = open_ > 0 ? Clock::now() - since_ : Clock::duration::zero();
    return std::chrono::duration<double>(total_ + now).count();
  }

 private:
  using Clock = std::chrono::steady_clock;

  void open() {
    const std::lock_guard lock(mutex_);
    if (open_++ == 0) since_ = Clock::now();
  }
  void close() {
    const std::lock_guard lock(mutex_);
    if (--open_ == 0) total_ += Clock::now() - since_;
  }

  mutable std::mutex mutex_;
  int open_ = 0;
  Clock::time_point since_;
  Clock::duration total_{};
};

}  // namespace evodevo
