// The instruction sets for which the kernels of the CPU are compiled. Included before <hwy/foreach_target.h>.
#pragma once

// disables instruction sets that are rare, or no faster for this code than the next lower one
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
