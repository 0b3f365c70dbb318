#pragma once
// The transforms that glare needs, in double, of many rows or columns at a time. The one
// place that knows the library (pocketfft, Reinecke and Bell, BSD-3; src/DECISIONS.md).

#include <complex>
#include <cstddef>

#include "num/isa.h"

namespace brume::glare {

using Complex = std::complex<double>;

struct FftKernels {
  /// The smallest length >= n whose transform is fast (prime factors 2, 3, 5, 7, 11).
  std::size_t (*fast_length)(std::size_t n);

  /// `rows` rows of `n` numbers, `n` apart, into rows of n / 2 + 1, `out_stride` apart:
  /// out[u] = sum_x in[x] exp(-2 pi i u x / n).
  void (*forward_rows)(const double* in, std::size_t rows, std::size_t n, Complex* out,
                       std::size_t out_stride);

  /// Back, not scaled: forward and back multiply by n. Imaginary parts of out[0] and (n
  /// even) out[n / 2] are ignored.
  void (*backward_rows)(const Complex* in, std::size_t rows, std::size_t n,
                        std::size_t in_stride, double* out);

  /// Transforms `columns` columns that lie side by side, in place: data[y columns + x], n
  /// rows. `forward` has the sign of forward_rows; neither is scaled.
  void (*transform_columns)(Complex* data, std::size_t n, std::size_t columns,
                            bool forward);

  /// The baseline's: out = image * kernel, both H rows of W floats, round and round, by
  /// whole transforms in float.
  void (*plain)(const float* image, const float* kernel, std::size_t H, std::size_t W,
                float* out);
};
BRUME_ISA_DECLARE(FftKernels, fft_kernels)

/// Those of the instruction set in use.
inline const FftKernels& fft() {
  static const FftKernels& kernels = BRUME_ISA_SELECT(fft_kernels);
  return kernels;
}

}  // namespace brume::glare
