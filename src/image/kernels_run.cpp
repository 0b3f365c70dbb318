#include <immintrin.h>

#include <cstring>

#include "image/kernels.h"

namespace brume::exr::inline BRUME_ISA_NS {
namespace {

using Byte = std::uint8_t;
constexpr std::uint32_t kLargestHalf = 0x477fe000, kInfinity = 0x7f800000;  // 65504, inf

template <class T>
BRUME_INLINE T load(const Byte* p) {
  T value;
  std::memcpy(&value, p, sizeof(T));
  return value;
}

// Half to float by integers: move exponent and mantissa into place and correct the
// exponent's bias. Denormal halves get their value from a float subtraction, which is
// exact: 2^-14 (1 + m/1024) - 2^-14.
BRUME_INLINE std::uint32_t float_bits(std::uint32_t h) {
  constexpr std::uint32_t kExponent = 0x7c00u << 13, kSmallest = 113u << 23;  // 2^-14
  const std::uint32_t shifted = (h & 0x7fff) << 13, exponent = shifted & kExponent;
  const std::uint32_t denormal =
      __builtin_bit_cast(std::uint32_t, __builtin_bit_cast(float, shifted + kSmallest) -
                                            __builtin_bit_cast(float, kSmallest));
  std::uint32_t bits = shifted + (exponent == kExponent ? 224u << 23 : 112u << 23);
  bits = exponent == 0 ? denormal : bits;
  return bits | (h & 0x8000) << 16;
}

// Float to half. Normal: add half a unit of the last half bit, less one, plus the bit
// that decides ties, and cut. Denormal: adding 0.5 lets the float adder round at half's
// last place, 2^-24.
BRUME_INLINE std::uint32_t half_bits(std::uint32_t f) {
  const std::uint32_t magnitude = f & 0x7fffffff;
  const std::uint32_t capped = magnitude > kLargestHalf ? kLargestHalf : magnitude;
  const std::uint32_t normal = (capped - (112u << 23) + 0xfff + (capped >> 13 & 1)) >> 13;
  const std::uint32_t denormal =
      __builtin_bit_cast(std::uint32_t, __builtin_bit_cast(float, capped) + 0.5f) -
      __builtin_bit_cast(std::uint32_t, 0.5f);
  const std::uint32_t payload = magnitude >> 13 & 0x3ff;
  std::uint32_t h = capped < (113u << 23) ? denormal : normal;
  h = magnitude == kInfinity ? 0x7c00 : h;
  h = magnitude > kInfinity ? 0x7c00 | payload | (payload == 0) : h;
  return h | (f >> 16 & 0x8000);
}

void float_from_half_plain(const Byte* half, float* out, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t bits = float_bits(load<std::uint16_t>(half + 2 * i));
    std::memcpy(out + i, &bits, 4);
  }
}

std::size_t half_from_float_plain(const float* in, Byte* half, std::size_t n) noexcept {
  std::uint32_t overflows = 0;
  for (std::size_t i = 0; i < n; ++i) {
    std::uint32_t bits;
    std::memcpy(&bits, in + i, 4);
    const auto h = static_cast<std::uint16_t>(half_bits(bits));
    std::memcpy(half + 2 * i, &h, 2);
    const std::uint32_t magnitude = bits & 0x7fffffff;
    overflows += magnitude > kLargestHalf && magnitude < kInfinity;
  }
  return overflows;
}

#ifdef __F16C__
// The processor's conversion, eight at a time. It makes signalling NaN quiet and
// overflow infinite: groups that hold such values take the plain way.
void float_from_half(const Byte* half, float* out, std::size_t n) noexcept {
  const __m128i largest = _mm_set1_epi16(0x7c00), magnitude = _mm_set1_epi16(0x7fff);
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    const __m128i h = _mm_loadu_si128(reinterpret_cast<const __m128i*>(half + 2 * i));
    const __m128i nan = _mm_cmpgt_epi16(_mm_and_si128(h, magnitude), largest);
    if (_mm_testz_si128(nan, nan)) [[likely]]
      _mm256_storeu_ps(out + i, _mm256_cvtph_ps(h));
    else
      float_from_half_plain(half + 2 * i, out + i, 8);
  }
  float_from_half_plain(half + 2 * i, out + i, n - i);
}

std::size_t half_from_float(const float* in, Byte* half, std::size_t n) noexcept {
  const __m256i largest = _mm256_set1_epi32(kLargestHalf);
  const __m256i magnitude = _mm256_set1_epi32(0x7fffffff);
  std::size_t i = 0, overflows = 0;
  for (; i + 8 <= n; i += 8) {
    const __m256 f = _mm256_loadu_ps(in + i);
    const __m256i large =
        _mm256_cmpgt_epi32(_mm256_and_si256(_mm256_castps_si256(f), magnitude), largest);
    if (_mm256_testz_si256(large, large)) [[likely]]
      _mm_storeu_si128(reinterpret_cast<__m128i*>(half + 2 * i),
                       _mm256_cvtps_ph(f, _MM_FROUND_TO_NEAREST_INT));
    else
      overflows += half_from_float_plain(in + i, half + 2 * i, 8);
  }
  return overflows + half_from_float_plain(in + i, half + 2 * i, n - i);
}
#else
constexpr auto float_from_half = float_from_half_plain;
constexpr auto half_from_float = half_from_float_plain;
#endif

void float_from_uint(const Byte* in, float* out, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i)
    out[i] = static_cast<float>(load<std::uint32_t>(in + 4 * i));
}

void uint_from_float(const float* in, Byte* out, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    std::uint32_t u = 0;
    if (in[i] >= 4294967296.0f)
      u = 0xffffffffu;
    else if (in[i] > 0)
      u = static_cast<std::uint32_t>(double(in[i]) + 0.5);  // exact in double, then cut
    std::memcpy(out + 4 * i, &u, 4);
  }
}

// Running sums of the 16 bytes of each lane, by doubling.
#ifdef __AVX2__
BRUME_INLINE __m256i running_sum(__m256i x) {
  x = _mm256_add_epi8(x, _mm256_bslli_epi128(x, 1));
  x = _mm256_add_epi8(x, _mm256_bslli_epi128(x, 2));
  x = _mm256_add_epi8(x, _mm256_bslli_epi128(x, 4));
  return _mm256_add_epi8(x, _mm256_bslli_epi128(x, 8));
}
#endif
BRUME_INLINE __m128i running_sum(__m128i x) {
  x = _mm_add_epi8(x, _mm_bslli_si128(x, 1));
  x = _mm_add_epi8(x, _mm_bslli_si128(x, 2));
  x = _mm_add_epi8(x, _mm_bslli_si128(x, 4));
  return _mm_add_epi8(x, _mm_bslli_si128(x, 8));
}

Byte sum_of_bytes(const Byte* p, std::size_t n) noexcept {
  const __m128i zero = _mm_setzero_si128();
  __m128i sum = zero;
  std::size_t i = 0;
  for (; i + 16 <= n; i += 16)
    sum = _mm_add_epi64(
        sum,
        _mm_sad_epu8(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p + i)), zero));
  auto total = static_cast<unsigned>(_mm_cvtsi128_si32(sum) + _mm_extract_epi32(sum, 2));
  for (; i < n; ++i) total += p[i];
  return static_cast<Byte>(total);
}

// Both halves run together: the second starts where the first will end, which the sum of
// the first half's bytes says. x - 128 is x xor 128 modulo 256; the very first byte is
// not a difference, hence the start at 128.
void undo_predictor(const Byte* in, Byte* out, std::size_t n) noexcept {
  if (n == 0) return;
  const std::size_t half = n / 2, larger = n - half;
  const Byte *first = in, *second = in + larger;
  Byte a = 128;
  Byte b = static_cast<Byte>(sum_of_bytes(first, larger) + 128 * (larger + 1));
  std::size_t i = 0;
  auto at = [](const Byte* p) { return reinterpret_cast<const __m128i*>(p); };
  auto to = [](Byte* p) { return reinterpret_cast<__m128i*>(p); };
#ifdef __AVX2__
  const __m256i bias = _mm256_set1_epi8(-128), last = _mm256_set1_epi8(15);
  __m256i carry = _mm256_set_m128i(_mm_set1_epi8(static_cast<char>(b)),
                                   _mm_set1_epi8(static_cast<char>(a)));
  for (; i + 16 <= half; i += 16) {
    __m256i x =
        _mm256_set_m128i(_mm_loadu_si128(at(second + i)), _mm_loadu_si128(at(first + i)));
    x = _mm256_add_epi8(running_sum(_mm256_xor_si256(x, bias)), carry);
    carry = _mm256_shuffle_epi8(x, last);
    const __m128i x1 = _mm256_castsi256_si128(x), x2 = _mm256_extracti128_si256(x, 1);
    _mm_storeu_si128(to(out + 2 * i), _mm_unpacklo_epi8(x1, x2));
    _mm_storeu_si128(to(out + 2 * i + 16), _mm_unpackhi_epi8(x1, x2));
  }
  a = static_cast<Byte>(_mm256_extract_epi8(carry, 0));
  b = static_cast<Byte>(_mm256_extract_epi8(carry, 16));
#else
  const __m128i bias = _mm_set1_epi8(-128), last = _mm_set1_epi8(15);
  __m128i carry1 = _mm_set1_epi8(static_cast<char>(a));
  __m128i carry2 = _mm_set1_epi8(static_cast<char>(b));
  for (; i + 16 <= half; i += 16) {
    __m128i x1 = _mm_xor_si128(_mm_loadu_si128(at(first + i)), bias);
    __m128i x2 = _mm_xor_si128(_mm_loadu_si128(at(second + i)), bias);
    x1 = _mm_add_epi8(running_sum(x1), carry1);
    x2 = _mm_add_epi8(running_sum(x2), carry2);
    carry1 = _mm_shuffle_epi8(x1, last);
    carry2 = _mm_shuffle_epi8(x2, last);
    _mm_storeu_si128(to(out + 2 * i), _mm_unpacklo_epi8(x1, x2));
    _mm_storeu_si128(to(out + 2 * i + 16), _mm_unpackhi_epi8(x1, x2));
  }
  a = static_cast<Byte>(_mm_extract_epi8(carry1, 0));
  b = static_cast<Byte>(_mm_extract_epi8(carry2, 0));
#endif
  for (; i < half; ++i) {
    a = static_cast<Byte>(a + first[i] - 128);
    b = static_cast<Byte>(b + second[i] - 128);
    out[2 * i] = a;
    out[2 * i + 1] = b;
  }
  if (larger > half) out[n - 1] = static_cast<Byte>(a + first[i] - 128);
}

// Bytes two apart are neighbours once even and odd are parted: subtract first, part
// after.
void apply_predictor(const Byte* in, Byte* out, std::size_t n) noexcept {
  if (n == 0) return;
  const std::size_t half = n / 2, larger = n - half;
  Byte *first = out, *second = out + larger;
  first[0] = in[0];
  if (n == 1) return;
  second[0] = static_cast<Byte>(in[1] - in[2 * (larger - 1)] + 128);
  std::size_t i = 1;
  auto at = [](const Byte* p) { return reinterpret_cast<const __m128i*>(p); };
  auto to = [](Byte* p) { return reinterpret_cast<__m128i*>(p); };
  const __m128i bias = _mm_set1_epi8(-128), low = _mm_set1_epi16(0xff);
  for (; i + 16 <= half; i += 16) {
    const Byte* p = in + 2 * i;
    const __m128i x = _mm_xor_si128(
        _mm_sub_epi8(_mm_loadu_si128(at(p)), _mm_loadu_si128(at(p - 2))), bias);
    const __m128i y = _mm_xor_si128(
        _mm_sub_epi8(_mm_loadu_si128(at(p + 16)), _mm_loadu_si128(at(p + 14))), bias);
    _mm_storeu_si128(to(first + i),
                     _mm_packus_epi16(_mm_and_si128(x, low), _mm_and_si128(y, low)));
    _mm_storeu_si128(to(second + i),
                     _mm_packus_epi16(_mm_srli_epi16(x, 8), _mm_srli_epi16(y, 8)));
  }
  for (; i < half; ++i) {
    first[i] = static_cast<Byte>(in[2 * i] - in[2 * i - 2] + 128);
    second[i] = static_cast<Byte>(in[2 * i + 1] - in[2 * i - 1] + 128);
  }
  if (larger > half && n > 1)
    first[i] = static_cast<Byte>(in[2 * i] - in[2 * i - 2] + 128);
}

}  // namespace

const Kernels kernel_table = {float_from_half, half_from_float, float_from_uint,
                              uint_from_float, undo_predictor,  apply_predictor};

}  // namespace brume::exr::inline BRUME_ISA_NS
