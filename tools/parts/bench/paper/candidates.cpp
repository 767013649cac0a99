#include "paper/candidates.hpp"

#include "common/bodies.hpp"

namespace evodevo::tools::bench {

std::string description(const PaperMethod& method) {
  return "springs " + name(method.order) + ", blocks of " + std::to_string(method.threads) + " threads";
}

TimedMethod::TimedMethod(const Settings& settings, const Body& body, const PaperMethod& method)
    : simulator_({&body, 1}, settings.bodies, walking_scene(), time_step, method), steps_(settings.steps) {
  simulator_.run(1);  // warm-up
}

double TimedMethod::rate() {
  simulator_.restart();
  const double seconds = simulator_.run(steps_);
  simulator_.state(0);  // throws if the body has diverged
  return static_cast<double>(simulator_.springs()) * static_cast<double>(steps_) / seconds;
}

Candidate fastest(const Settings& settings, const Body& body, MassMemory memory) {
  Candidate best;
  unsigned tried = 0;
  for (const SpringOrder order : spring_orders) {
    for (const unsigned threads : {256u, 512u, 1024u}) {
      const PaperMethod method{.memory = memory, .order = order, .threads = threads};
      const double rate = TimedMethod(settings, body, method).rate();
      ++tried;
      if (rate > best.rate) best = {method, rate, 0};
    }
  }
  best.tried = tried;
  return best;
}

}  // namespace evodevo::tools::bench
