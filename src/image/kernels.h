#pragma once
// The inner loops of reading and writing: number formats and the byte shuffles of the ZIP
// and RLE codecs. Compiled once per instruction set (kernels_run.cpp).

#include <cstddef>
#include <cstdint>

#include "num/isa.h"

namespace brume::exr {

struct Kernels {
  /// n halves (IEEE binary16, any alignment) to float, exactly; NaN keep their payload
  /// bits and stay signalling if they were, so that half -> float -> half is the identity
  /// for all 65536 values.
  void (*float_from_half)(const std::uint8_t* half, float* out, std::size_t n) noexcept;

  /// n floats to half, round to nearest even. Finite values beyond the largest half
  /// (65504) become it, sign kept; their number is returned. Infinities stay. NaN stay
  /// NaN with the upper ten payload bits.
  std::size_t (*half_from_float)(const float* in, std::uint8_t* half,
                                 std::size_t n) noexcept;

  /// n uint32 to the nearest float.
  void (*float_from_uint)(const std::uint8_t* in, float* out, std::size_t n) noexcept;

  /// n floats to the nearest uint32, ties up; negative and NaN to 0, too large to
  /// 2^32 - 1.
  void (*uint_from_float)(const float* in, std::uint8_t* out, std::size_t n) noexcept;

  /// What ZIP and RLE hold, back to pixel bytes: running sum (b[i] += b[i-1] - 128), then
  /// the first half of the bytes (the larger when n is odd) and the second alternate.
  void (*undo_predictor)(const std::uint8_t* in, std::uint8_t* out,
                         std::size_t n) noexcept;

  /// The inverse: even bytes first, odd bytes after, then differences.
  void (*apply_predictor)(const std::uint8_t* in, std::uint8_t* out,
                          std::size_t n) noexcept;
};
BRUME_ISA_DECLARE(Kernels, kernel_table)

/// The kernels of the instruction set in use.
inline const Kernels& kernels() {
  static const Kernels& chosen = BRUME_ISA_SELECT(kernel_table);
  return chosen;
}

}  // namespace brume::exr
