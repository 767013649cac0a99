// The channels of samples.
#pragma once

#include "evodevo/channels.hpp"

namespace evodevo::test {

constexpr Channels all_channels{true, true, true, true, true, true, true, true};

}  // namespace evodevo::test
