#pragma once
// Random numbers without a state to carry: the n-th number of a stream is a function of
// n. So a result does not depend on the order, the threads or the tile in which it is
// computed.

#include <array>
#include <cstdint>

#include "num/batch.h"

namespace brume::inline BRUME_ISA_NS {

// ---- for Monte Carlo -----------------------------------------------------------------

/// Philox4x32-10: four random words from a 128-bit counter and a 64-bit key.
/// (Salmon, Moraes, Dror & Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3";
/// passes BigCrush; the published test vectors are ours too.)
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                              std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xd2511f53} * counter[0];
    const std::uint64_t b = std::uint64_t{0xcd9e8d57} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0],
               static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1],
               static_cast<std::uint32_t>(a)};
    key = {key[0] + 0x9e3779b9, key[1] + 0xbb67ae85};
  }
  return counter;
}

/// A stream of random numbers; (seed, stream) names it.
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed, std::uint64_t stream = 0)
      : seed_(seed), stream_(stream) {}

  constexpr std::uint32_t word() {
    if (next_ % 4 == 0) {
      const std::uint64_t block = next_ / 4;
      words_ = philox({low(block), high(block), low(stream_), high(stream_)},
                      {low(seed_), high(seed_)});
    }
    return words_[next_++ % 4];
  }
  /// Uniform in [0, 1), a multiple of 2^-53.
  constexpr double uniform() {
    const std::uint64_t a = word() >> 5, b = word() >> 6;
    return static_cast<double>(a << 26 | b) * 0x1p-53;
  }
  /// Uniform in [lo, hi).
  constexpr double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }

 private:
  static constexpr std::uint32_t low(std::uint64_t x) {
    return static_cast<std::uint32_t>(x);
  }
  static constexpr std::uint32_t high(std::uint64_t x) {
    return static_cast<std::uint32_t>(x >> 32);
  }
  std::uint64_t seed_, stream_, next_ = 0;
  std::array<std::uint32_t, 4> words_ = {};
};

// ---- for kernels ---------------------------------------------------------------------

/// The integers that go with T in lattices and hashes: 32 bits a lane, for double too, so
/// that all three see the same world.
template <Real T>
using Cell_t = std::conditional_t<lanes<T> == 1, std::uint32_t, Bits_t<T>>;

/// Four integers hashed into four: pcg4d (Jarzynski & Olano 2020, "Hash functions for GPU
/// rendering", JCGT 9(3)). U = std::uint32_t or IntBatch. The upper bits are mixed best.
template <class U>
struct Hash {
  U x, y, z, w;
};
template <class U>
BRUME_INLINE Hash<U> hash(U x, U y, U z, U w) {
  const auto step = [](U v) { return v * U(1664525u) + U(1013904223u); };
  x = step(x), y = step(y), z = step(z), w = step(w);
  x = x + y * w, y = y + z * x, z = z + x * y, w = w + y * z;
  x = x ^ (x >> 16), y = y ^ (y >> 16), z = z ^ (z >> 16), w = w ^ (w >> 16);
  x = x + y * w, y = y + z * x, z = z + x * y, w = w + y * z;
  return {x, y, z, w};
}

/// A hash as a number uniform in [0, 1), a multiple of 2^-23.
template <Real T>
BRUME_INLINE T uniform(Cell_t<T> h) {
  // The upper bits become the mantissa of a number in [1, 2).
  if constexpr (is_double<T>)
    return static_cast<double>(h >> 9) * 0x1p-23;
  else
    return value((h >> 9) | Cell_t<T>(0x3f800000u)) - T(1);
}

}  // namespace brume::inline BRUME_ISA_NS
