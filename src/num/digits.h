#pragma once
// A double as two floats.

#include <bit>
#include <cstdint>

namespace brume {

/// The leading 24 bits of a double, what a float holds of it (of a normal one); x less it
/// is exact. By its bits, because g++ 12.2 takes x - double(float(x)) for 0 where it
/// vectorises it over an array (-O3; tests of scene and fog_volume tell).
inline double first_24_bits(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & ~((1ull << 29) - 1));
}

}  // namespace brume
