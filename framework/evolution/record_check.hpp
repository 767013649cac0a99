// Whether what a run has recorded fits its experiment. All of these throw ArchiveError where it does not: a record may
// come from anywhere, and no operator is to blame for what it holds.
#pragma once

#include "evolution/archive/archive.hpp"

namespace evodevo {

void check_objectives(const Archive& archive, const Experiment& experiment);

/// That an individual's genes are those that the encoding lays out.
void check_genes(const Archive& archive, const Experiment& experiment, const Individual& individual);

/// That a run can go on from what it has: reads all that evolve() will.
void check_resumable(const Archive& archive, const Experiment& experiment);

/// That the record of an individual's life names cycles and operators that there are. Whether its edits fit the body
/// shows when they are made.
void check_life(const Archive& archive, const Experiment& experiment, std::uint32_t individual,
                const LifeRecord& record);

}  // namespace evodevo
