#include "image/kernels.h"

#include <bit>
#include <cmath>
#include <cstring>

namespace brume::kernels {
namespace {

// Half to float by integers: move exponent and mantissa into place and correct the
// exponent's bias. Denormal halves get their value from a float subtraction, which is
// exact: 2^-14 (1 + m/1024) - 2^-14.
inline std::uint32_t float_bits(std::uint32_t h) {
  constexpr std::uint32_t kExponent = 0x7c00u << 13;
  const std::uint32_t shifted = (h & 0x7fff) << 13, exponent = shifted & kExponent;
  const std::uint32_t normal = shifted + (112u << 23);
  const std::uint32_t denormal = std::bit_cast<std::uint32_t>(
      std::bit_cast<float>(shifted + (113u << 23)) - std::bit_cast<float>(113u << 23));
  std::uint32_t bits = exponent == kExponent ? shifted + (224u << 23) : normal;
  bits = exponent == 0 ? denormal : bits;
  return bits | (h & 0x8000) << 16;
}

// Float to half. Normal: add half a unit of the last half bit, less one, plus the bit
// that decides ties, and cut. Denormal: adding 0.5 lets the float adder round at half's
// last place 2^-24.
inline std::uint32_t half_bits(std::uint32_t f) {
  constexpr std::uint32_t kInfinity = 0x7f800000, kTooLarge = 0x477fe000;  // 65504
  const std::uint32_t magnitude = f & 0x7fffffff;
  const std::uint32_t capped = magnitude > kTooLarge ? kTooLarge : magnitude;
  const std::uint32_t normal = (capped - (112u << 23) + 0xfff + (capped >> 13 & 1)) >> 13;
  const std::uint32_t denormal =
      std::bit_cast<std::uint32_t>(std::bit_cast<float>(capped) + 0.5f) -
      std::bit_cast<std::uint32_t>(0.5f);
  const std::uint32_t payload = magnitude >> 13 & 0x3ff;
  const std::uint32_t nan = 0x7c00 | payload | (payload == 0);
  std::uint32_t h = capped < (113u << 23) ? denormal : normal;
  h = magnitude == kInfinity ? 0x7c00 : h;
  h = magnitude > kInfinity ? nan : h;
  return h | (f >> 16 & 0x8000);
}

template <class T>
inline T load(const std::uint8_t* p) {
  T value;
  std::memcpy(&value, p, sizeof(T));
  return value;
}

}  // namespace

void float_from_half(const std::uint8_t* half, float* out, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t bits = float_bits(load<std::uint16_t>(half + 2 * i));
    std::memcpy(out + i, &bits, 4);
  }
}

std::size_t half_from_float(const float* in, std::uint8_t* half, std::size_t n) noexcept {
  std::size_t overflows = 0;
  for (std::size_t i = 0; i < n; ++i) {
    std::uint32_t bits;
    std::memcpy(&bits, in + i, 4);
    const auto h = static_cast<std::uint16_t>(half_bits(bits));
    std::memcpy(half + 2 * i, &h, 2);
    const std::uint32_t magnitude = bits & 0x7fffffff;
    overflows += magnitude > 0x477fe000 && magnitude < 0x7f800000;
  }
  return overflows;
}

void float_from_uint(const std::uint8_t* in, float* out, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i)
    out[i] = static_cast<float>(load<std::uint32_t>(in + 4 * i));
}

void uint_from_float(const float* in, std::uint8_t* out, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    std::uint32_t u = 0;
    if (in[i] >= 4294967296.0f)
      u = 0xffffffffu;
    else if (in[i] > 0)
      u = static_cast<std::uint32_t>(std::floor(double(in[i]) + 0.5));
    std::memcpy(out + 4 * i, &u, 4);
  }
}

void undo_predictor(std::uint8_t* in, std::uint8_t* out, std::size_t n) noexcept {
  for (std::size_t i = 1; i < n; ++i)
    in[i] = static_cast<std::uint8_t>(in[i] + in[i - 1] - 128);
  const std::uint8_t *first = in, *second = in + (n + 1) / 2;
  for (std::size_t i = 0; i < n; ++i) out[i] = i & 1 ? second[i / 2] : first[i / 2];
}

void apply_predictor(const std::uint8_t* in, std::uint8_t* out, std::size_t n) noexcept {
  std::uint8_t *first = out, *second = out + (n + 1) / 2;
  for (std::size_t i = 0; i < n; ++i) (i & 1 ? second : first)[i / 2] = in[i];
  for (std::size_t i = n; i-- > 1;)
    out[i] = static_cast<std::uint8_t>(out[i] - out[i - 1] + 128);
}

}  // namespace brume::kernels
