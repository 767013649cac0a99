#include "core/slow_step.hpp"

#include <utility>

namespace evodevo {
namespace {

SlowStepListener& listener() {
  static SlowStepListener listener;
  return listener;
}

}  // namespace

void set_slow_step_listener(SlowStepListener new_listener) { listener() = std::move(new_listener); }

SlowStep::SlowStep(std::string what) : what_(std::move(what)), start_(std::chrono::steady_clock::now()) {
  if (listener()) listener()(what_, std::nullopt);
}

SlowStep::~SlowStep() {
  if (listener()) listener()(what_, std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
}

}  // namespace evodevo
