#include "base/philox.hpp"

#include <Random123/philox.h>

namespace evodevo {

void philox(const std::uint32_t* counter, const std::uint32_t* key, std::uint32_t* out) {
  const r123::Philox4x32::ctr_type block =
      r123::Philox4x32()({{counter[0], counter[1], counter[2], counter[3]}}, {{key[0], key[1]}});
  for (std::size_t i = 0; i < 4; ++i) out[i] = block[i];
}

}  // namespace evodevo
