// What the selection operators remember and note, in the archive.
#pragma once

#include "archive/database.hpp"
#include "archive/population.hpp"

namespace evodevo {

/// Writes the notes of a generation, and its memory in place of that of the generation before.
void write_remembered(const RunDatabase& run, const Remembered& remembered, std::uint32_t generation);

}  // namespace evodevo
