#pragma once
// The kernels, by instruction set, number of wavelengths and harmonics.

#include "num/isa.h"
#include "types.h"

namespace brume::sky {

struct KernelTable {
  Kernels<float> by[2][3];  // N = 4, 8; L = 2, 4, 6
};
BRUME_ISA_DECLARE(KernelTable, kernel_table)

/// Of the instruction set in use. N: 4 or 8, L: 2, 4 or 6.
inline const Kernels<float>& kernels(int N, int L) {
  return BRUME_ISA_SELECT(kernel_table).by[N == 8][L / 2 - 1];
}

}  // namespace brume::sky
