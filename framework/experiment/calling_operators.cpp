// How the host calls the operators of an experiment.
#include <algorithm>
#include <stdexcept>

#include "base/text.hpp"
#include "experiment/experiment.hpp"

namespace evodevo {

Experiment::~Experiment() {
  const auto end = [&](std::string_view kind, std::size_t index, auto& op) {
    const OperatorUse* use = use_of(*this, kind, index);
    const InOperator in_its_destructor({use != nullptr ? use->title : nullptr});
    op.reset();
  };
  end(Encoding::kind, 0, encoding);
  end(Selection::kind, 0, selection);
  for (std::size_t i = 0; i < mutations.size(); ++i) end(Mutation::kind, i, mutations[i].op);
  for (std::size_t i = 0; i < crossovers.size(); ++i) end(Crossover::kind, i, crossovers[i].op);
  for (std::size_t i = 0; i < development.operators.size(); ++i) end(Devo::kind, i, development.operators[i].op);
  for (std::size_t i = 0; i < fitness.size(); ++i) end(Fitness::kind, i, fitness[i]);
}

SpringRequest devo_request(const Experiment& experiment, std::size_t index) {
  return call_operator(experiment, Devo::kind, index, {},
                       [&] { return experiment.development.operators.at(index).op->observes(); });
}

Request fitness_request(const Experiment& experiment, std::size_t index) {
  return call_operator(experiment, Fitness::kind, index, {}, [&] { return experiment.fitness.at(index)->observes(); });
}

Recording recording(const Experiment& experiment, std::int64_t cycle) {
  Recording all;
  const Development& development = experiment.development;
  if (development.control == Control::no_change) return all;
  for (std::size_t i = 0; i < development.operators.size(); ++i) {
    if (!development.operators[i].schedule.contains(cycle)) continue;
    const SpringRequest request = devo_request(experiment, i);
    all.stress |= request.stress;
    all.peak_force |= request.peak_force;
    all.muscle_work |= request.muscle_work;
    all.tension |= request.tension;
  }
  return all;
}

const OperatorUse* use_of(const Experiment& experiment, std::string_view kind, std::size_t index) {
  const auto use = std::find_if(experiment.uses.begin(), experiment.uses.end(),
                                [&](const OperatorUse& other) { return other.kind == kind && index-- == 0; });
  return use == experiment.uses.end() ? nullptr : &*use;
}

void blame_operator(const OperatorCall& call, std::string_view kind, const std::string& what) {
  const std::string unnamed = call.title == nullptr ? std::string(kind) + " " : "";
  throw std::runtime_error(unnamed + text_of(call) + ": " + printable(what, 2000) +
                           "; correct the operator and build it again, or begin a new run without it");
}

}  // namespace evodevo
