#pragma once
// The kernels, by instruction set.

#include "kernel.h"
#include "num/isa.h"
#include "plugin.h"

namespace lightning {

struct Kernels {
  void (*integral)(const Channel&, const brume_rays&, const float* t0, const float* t1,
                   float* D) noexcept;
  void (*density)(const Channel&, const brume_rays&, const float* t, float* rho) noexcept;
};
BRUME_ISA_DECLARE(Kernels, kernels)

}  // namespace lightning
