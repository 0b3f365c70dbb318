#include "fft.h"

// Threads are ours (TBB). Plans of the few lengths of a sequence stay in its cache.
#define POCKETFFT_NO_MULTITHREADING
#include <pythran/pythonic/numpy/fft/pocketfft.hpp>

namespace brume::glare::inline BRUME_ISA_NS {
namespace {

constexpr std::ptrdiff_t kReal = sizeof(double), kComplex = sizeof(Complex);

std::size_t fast_length(std::size_t n) {
  return pocketfft::detail::util::good_size_real(n);
}

void forward_rows(const double* in, std::size_t rows, std::size_t n, Complex* out,
                  std::size_t out_stride) {
  pocketfft::r2c<double>({rows, n}, {std::ptrdiff_t(n) * kReal, kReal},
                         {std::ptrdiff_t(out_stride) * kComplex, kComplex},
                         std::size_t{1}, pocketfft::FORWARD, in, out, 1.);
}

void backward_rows(const Complex* in, std::size_t rows, std::size_t n,
                   std::size_t in_stride, double* out) {
  pocketfft::c2r<double>({rows, n}, {std::ptrdiff_t(in_stride) * kComplex, kComplex},
                         {std::ptrdiff_t(n) * kReal, kReal}, std::size_t{1},
                         pocketfft::BACKWARD, in, out, 1.);
}

void transform_columns(Complex* data, std::size_t n, std::size_t columns, bool forward) {
  const pocketfft::stride_t stride{std::ptrdiff_t(columns) * kComplex, kComplex};
  pocketfft::c2c<double>({n, columns}, stride, stride, {0},
                         forward ? pocketfft::FORWARD : pocketfft::BACKWARD, data, data,
                         1.);
}

void plain(const float* image, const float* kernel, std::size_t H, std::size_t W,
           float* out) {
  const std::size_t wide = W / 2 + 1;
  const pocketfft::shape_t shape{H, W}, axes{0, 1};
  const pocketfft::stride_t real{std::ptrdiff_t(W * sizeof(float)), sizeof(float)},
      complex{std::ptrdiff_t(wide * sizeof(std::complex<float>)),
              sizeof(std::complex<float>)};
  std::vector<std::complex<float>> a(wide * H), b(wide * H);
  pocketfft::r2c(shape, real, complex, axes, pocketfft::FORWARD, image, a.data(), 1.f);
  pocketfft::r2c(shape, real, complex, axes, pocketfft::FORWARD, kernel, b.data(), 1.f);
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] = {a[i].real() * b[i].real() - a[i].imag() * b[i].imag(),
            a[i].real() * b[i].imag() + a[i].imag() * b[i].real()};
  pocketfft::c2r(shape, complex, real, axes, pocketfft::BACKWARD, a.data(), out,
                 1 / (float(W) * float(H)));
}

}  // namespace

const FftKernels fft_kernels = {fast_length, forward_rows, backward_rows,
                                transform_columns, plain};

}  // namespace brume::glare::inline BRUME_ISA_NS
