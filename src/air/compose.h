#pragma once
// Several media, each alone on its own stretch of the ray.

#include "air/medium.h"
#include "num/isa.h"

namespace brume::air {

/// k media on n rays, T and L as the closed forms gave them (Stretch); in canonical
/// order.
struct Layers {
  int k = 0;
  const Medium* const* media = nullptr;
  const Stretch* at = nullptr;
  int* order = nullptr;  ///< room for k
  float* key = nullptr;  ///< room for k
  bool shares = false;   ///< each L_k is left attenuated: its share
};

/// Where two media overlap without mattering to each other: in every channel at most one
/// is there, or neither dims, or both add the same source per optical depth.
/// (compile.cpp)
bool indifferent(const Medium& a, const Medium& b);

struct ComposeKernels {
  /// T = product of all T. L = sum of L_k times the T of all that begin before k, which
  /// is exact where no two media overlap, and where those that do have the same source or
  /// no extinction. Products and sums go by where the media begin on that ray (ties:
  /// canonical order), whatever the rays beside it do.
  /// walk[i] = 1 where that does not hold on ray i, or where a medium is on it that is
  /// neither closed nor answers for itself, else 0.
  /// Returns whether any is 1.
  bool (*compose)(const Layers&, int n, float* const T[3], float* const L[3],
                  float* walk) noexcept;
};
BRUME_ISA_DECLARE(ComposeKernels, compose_kernels)

}  // namespace brume::air
