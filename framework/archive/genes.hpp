// Genomes in the archive: the tables that describe them, and the blobs that hold them (README.md, blobs).
#pragma once

#include <string>

#include "archive/database.hpp"
#include "evodevo/genome.hpp"

namespace evodevo {

/// Writes the layout of whole genomes.
void insert_layout(const RunDatabase& run, const Layout& layout);
/// Reads it. Throws ArchiveError if the tables do not describe a layout.
Layout read_layout(const RunDatabase& run);

/// Returns the blocks of a genome as bytes; only those in sections whose blocks come and go.
std::string block_bytes(const Genome& genome, const Layout& layout);
/// Reads a genome from a row: its genes from the column `genes`, its blocks from the column `blocks`. Only checks that
/// both fit together; genome_fault() checks the values of genes. Throws ArchiveError.
Genome read_genome(const Statement& row, int genes, int blocks, const Layout& layout);

}  // namespace evodevo
