#pragma once
// The row kernels of the instruction set in use. Not for kernel files.

#include "pipeline/composite.h"
#include "pipeline/sole.h"

namespace brume::pipeline {

inline const CompositeKernels& kernels() {
  static const CompositeKernels& chosen = BRUME_ISA_SELECT(composite_kernels);
  return chosen;
}

inline const SoleKernels& kernels_of_one_fog() {
  static const SoleKernels& chosen = BRUME_ISA_SELECT(sole_kernels);
  return chosen;
}

}  // namespace brume::pipeline
