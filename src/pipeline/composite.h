#pragma once
// Laying air over samples: the arithmetic of DESIGN "Exact meanings", for a run of
// pixels.

#include "num/isa.h"

namespace brume::pipeline {

/// A run of n samples and the air before and behind them; null where a plane is not
/// there.
struct CompositeRun {
  int n = 0;
  const float* S[3];  ///< premultiplied colour after surface stages
  const float* a;     ///< coverage; null: 1 (pixels taken as covered)
  const float* T[3];  ///< air up to the sample
  const float* L[3];
  const float* T_inf[3];  ///< air to infinity; null: the same as T, L
  const float* L_inf[3];
  const float* B[3];   ///< background radiance; null: none
  const float* fills;  ///< how much of a background there is, 0 to 1; null: all of it
  float* C[3];         ///< out: T S + L (may be S itself)
  float* a_out;        ///< out: coverage after the air; null: not wanted
  float* L_out[3];     ///< out: a L + (1 - a)(L_inf + T_inf B); null: not wanted (T is an
                       ///< AOV as it is)
};

struct CompositeKernels {
  /// C' = T S + a L + (1 - a)(L_inf + T_inf B), a' = a + (1 - a)(1 - mean T_inf); a' = 1
  /// where there is a background, and no less than a + (1 - a) `fills` where there is a
  /// part of one. A pixel with T = 1 and nothing to add keeps its bits, NaN payload
  /// included; T = 0 times an infinite colour is 0. Coverage outside [0, 1] counts as the
  /// nearest, NaN as 1. Returns whether any pixel was touched.
  bool (*composite)(const CompositeRun&) noexcept;

  /// out = before + w (after - before), exactly `before` where w is 0 and `after` where
  /// it is 1.
  void (*blend)(int n, const float* before, const float* after, const float* w,
                float* out) noexcept;
  /// out = after - before, 0 where that is no number.
  void (*difference)(int n, const float* after, const float* before, float* out) noexcept;

  /// w = saturate(mask) x mix; NaN in the mask counts as 0.
  void (*weight)(int n, const float* mask, float mix, float* w) noexcept;

  /// Whether any pixel needs both integrals: a < 1 and distance < inf.
  bool (*needs_infinity)(int n, const float* a, const float* distance) noexcept;
};

BRUME_ISA_DECLARE(CompositeKernels, composite_kernels)

}  // namespace brume::pipeline
