#pragma once
// The kernels, by instruction set, number of wavelengths and harmonics.

#include "num/isa.h"
#include "types.h"

namespace brume::sky {

constexpr int kHarmonics[] = {2, 4, 6, 10};

struct KernelTable {
  Kernels<float> by[2][4];  // N = 4, 8; L as in kHarmonics
};
BRUME_ISA_DECLARE(KernelTable, kernel_table)

/// Of the instruction set in use. N: 4 or 8; L: the largest of kHarmonics that is no
/// larger.
inline const Kernels<float>& kernels(int N, int L) {
  int i = 0;
  while (i < 3 && kHarmonics[i + 1] <= L) ++i;
  return BRUME_ISA_SELECT(kernel_table).by[N == 8][i];
}

}  // namespace brume::sky
