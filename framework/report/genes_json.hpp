// The genes of an individual by name.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "evodevo/genome.hpp"

namespace evodevo {

/// Returns the id of a block as reports show it: 16 hexadecimal digits.
std::string id_text(BlockId id);

/// Returns the name of a gene of a block, for example "bias" or "weight 3". `type` is one of the layout of whole
/// genomes, which has a name, maybe empty, for every gene that it lists; a gene without a name is called by its number.
std::string gene_name(const BlockType& type, const Block& block, std::uint32_t gene);

/// Returns the sections of a genome with their owners and blocks, and the genes of each block by name. Ids are texts of
/// 16 hexadecimal digits. References are the ids of the blocks to which they refer, choices the names of the options,
/// or their numbers if the options have no names. The layout must allow the genome.
nlohmann::ordered_json genes_json(const Genome& genome, const Layout& layout);

}  // namespace evodevo
