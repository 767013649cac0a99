// Checks whether the record of a run fits the run's experiment. All functions throw ArchiveError if it does not. They
// run before operators see the record, because a record may come from anywhere, and operators must not be blamed for
// the errors in it.
#pragma once

#include "archive/archive.hpp"

namespace evodevo {

/// Checks that the recorded objectives are those of the experiment's fitness operators.
void check_objectives(const Archive& archive, const Experiment& experiment);

/// Checks that `recorded`, the experiment in the record, is the experiment that the user names, with equal contents of
/// its files. The message names the first line of both that differs.
void check_same_experiment(const Archive& archive, const Experiment& recorded, const Experiment& named);

/// Checks that the recorded layout of genomes is that of the experiment's operators.
void check_layout(const Archive& archive, const Experiment& experiment);

/// Checks that the recorded layout of genomes is that of the experiment's operators, and allows an individual's genes.
void check_genes(const Archive& archive, const Experiment& experiment, const Individual& individual);

/// Checks that the run can be resumed: reads and checks everything that the generation loop will read.
void check_resumable(const Archive& archive, const Experiment& experiment);

/// Checks that an individual has had all lives of which there are records, and that the cycles and operators in these
/// exist. Whether the recorded edits fit the body is checked only when they are applied.
void check_lives(const Archive& archive, const Experiment& experiment, const Newborn& newborn);

}  // namespace evodevo
