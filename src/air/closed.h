#pragma once
// One medium on rows of rays.

#include "air/medium.h"
#include "num/isa.h"

namespace brume::air {

struct ClosedKernels {
  /// Where each ray is inside the medium, what it lets through, and (closed media, out.L
  /// not null) what it adds: S (1 - e^-tau) + emission D exprel(tau). `weight`: n floats
  /// or null. Media that are not closed give L = 0. `ends`: out.hi, if not null, is where
  /// a cap ends the medium; else where it would end without one, which costs no search.
  void (*one)(const Medium&, const Compiled&, const Rays&, const float* weight,
              const Stretch& out, bool ends) noexcept;
};
BRUME_ISA_DECLARE(ClosedKernels, closed_kernels)

}  // namespace brume::air
