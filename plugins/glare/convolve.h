#pragma once
// Linear convolution of a frame's bright part with a kernel, by FFT in double and the few
// brightest pixels directly (README.md, "Convolution").

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "fft.h"
#include "kernel.h"

namespace brume::glare {

/// Padded lengths: whatever leaves the frame on one side does not come in on the other.
struct Layout {
  std::size_t width, height;  ///< of the frame
  std::size_t W, H;           ///< padded
  std::size_t columns() const { return W / 2 + 1; }
  Layout(int w, int h, const Kernel& k)
      : width(std::size_t(w)),
        height(std::size_t(h)),
        W(fft().fast_length(std::size_t(w) +
                            std::size_t(k.reach_x < w ? k.reach_x : w - 1))),
        H(fft().fast_length(std::size_t(h) +
                            std::size_t(k.reach_y < h ? k.reach_y : h - 1))) {}
};

/// Columns transformed together: two lines of cache per row.
inline constexpr std::size_t kStrip = 8;

/// The spectrum of a kernel without its centre, by strips of columns. Symmetric kernels
/// have a real one, held as such. Held as a whole where `hold`; else the columns'
/// transforms are made whenever they are asked for.
class KernelSpectrum {
 public:
  KernelSpectrum(const Kernel&, int channel, const Layout&, bool hold);

  /// Multiplies strip u (columns u kStrip ..., H rows of m) by it and by 1 / (W H).
  void multiply(std::size_t u, std::size_t m, Complex* strip) const;

  /// Bytes held.
  std::size_t bytes() const;
  static std::size_t bytes_held(const Layout&, bool symmetric);

 private:
  std::vector<Complex> column_strip(std::size_t u, std::size_t m) const;

  Layout layout_;
  int reach_y_;
  bool symmetric_;
  bool even_;                     // K(-x, y) = K(x, y): the rows' transforms are real
  std::vector<double> rows_;      // transforms of the kernel's rows, where not held
  std::vector<double> real_;      // held
  std::vector<Complex> complex_;  // held
};

/// A kernel ready for frames of one size.
struct Prepared {
  Kernel kernel;
  Layout layout;
  std::vector<std::unique_ptr<const KernelSpectrum>>
      spectra;  ///< one, or one per channel
  std::size_t bytes() const;
};

/// Prepares; spectra are held when all of them fit `budget` bytes, else only made one by
/// one (spectra empty).
std::shared_ptr<const Prepared> prepare(Kernel, int width, int height,
                                        std::size_t budget);

/// Kernels of a sequence, the last used kept: the newest, of up to kCacheBytes, and older
/// ones of a third of that. Thread-safe; one thread makes, others wait.
class Cache {
 public:
  std::shared_ptr<const Prepared> get(
      const std::string& key,
      const std::function<std::shared_ptr<const Prepared>()>& make) const;

 private:
  mutable std::mutex mutex_;
  mutable std::list<std::pair<std::string, std::shared_ptr<const Prepared>>> held_;
};
inline constexpr std::size_t kCacheBytes = std::size_t{900} << 20;

/// Light to be spread: `value(x, y)` is finite and >= 0.
struct Bright {
  const float* plane;   ///< the channel
  const float* weight;  ///< part of it that glares, `width` apart; null: all
  std::ptrdiff_t row_stride;
  double value(std::size_t x, std::size_t y, std::size_t width) const;
};

/// Calls row(y, c) for every row of the frame with c[x] = sum over s != x of K(x - s)
/// B(s), from several threads; c >= 0 within the error that README.md states. False (and
/// no calls) when the frame has no light. `room`
/// is memory, kept from call to call.
bool convolve(const Prepared&, int channel, const Bright&, std::vector<Complex>& room,
              const std::function<void(std::size_t y, const double* c)>& row);

}  // namespace brume::glare
