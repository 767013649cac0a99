#include "engine/builds.hpp"

#include <algorithm>

#include "archive/provenance.hpp"

namespace evodevo {
namespace {

std::string title(const OperatorUse& use) { return use.kind + " operator \"" + use.name + "\" " + use.version; }

std::string title(const Provenance& provenance) {
  return "evodevo " + provenance.version + " (" + provenance.program + ")";
}

/// Calls `report(then, now)` for each operator whose library is not the one with which the run began.
template <class Report>
void for_each_changed_operator(const Experiment& experiment, const Provenance& first, const Report& report) {
  const std::vector<OperatorUse>& past = first.operators;
  // both lists are in the same order, because a resumed run reads its operators from its own record
  for (std::size_t i = 0; i < past.size() && i < experiment.uses.size(); ++i)
    if (past[i].hash != experiment.uses[i].hash) report(past[i], experiment.uses[i]);
}

/// Whether something with the same builds, or the same device, has taken part in the run.
template <class Same>
bool has_taken_part(const Archive& archive, const Same& same) {
  return std::ranges::any_of(archive.provenances(), same);
}

}  // namespace

std::vector<std::string> other_builds(const Experiment& experiment, const Simulator& simulator,
                                      const Archive& archive) {
  std::vector<std::string> warnings;
  const auto warn = [&](const auto& then, const auto& now, const std::string& which) {
    warnings.push_back("the run began with " + title(then) + "; now " +
                       (then.version == now.version ? "another build of it" : "version " + now.version) + " is used, " +
                       which + "; results may differ");
  };
  const Provenance first = archive.provenances().front(), here = this_provenance(experiment, simulator.device());
  if (has_taken_part(archive, [&](const Provenance& one) { return are_same_builds(one, here); })) return warnings;
  if (first.program != here.program) warn(first, here, here.program);
  for_each_changed_operator(
      experiment, first, [&](const OperatorUse& then, const OperatorUse& now) { warn(then, now, now.file.string()); });
  return warnings;
}

std::vector<std::string> another_device(const Simulator& simulator, const Archive& archive) {
  if (has_taken_part(archive, [&](const Provenance& one) { return one.device == simulator.device(); })) return {};
  return {"the run began on " + archive.provenances().front().device + " and continues on " + simulator.device() +
          "; results may differ, at first in the last bit"};
}

void refuse_other_versions(const Experiment& experiment, const Archive& archive) {
  for_each_changed_operator(experiment, archive.provenances().front(),
                            [&](const OperatorUse& then, const OperatorUse& now) {
                              if (then.version == now.version) return;
                              throw ArchiveError(archive.folder().string() + ": the run began with " + title(then) +
                                                 ", but " + now.file.string() + " is version " + now.version +
                                                 "; put back the version that the run began with (it was " +
                                                 then.file.string() + "), or continue with --allow-other-versions");
                            });
}

}  // namespace evodevo
