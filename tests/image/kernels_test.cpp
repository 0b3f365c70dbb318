// The inner loops against their definitions, on every instruction set this machine has.

#include "image/kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace brume::exr {
namespace {

const Kernels& table(Isa isa) {
  return of_isa(isa, isa_v2::kernel_table, isa_v3::kernel_table, isa_v4::kernel_table);
}

class ImageKernels : public testing::TestWithParam<Isa> {
 protected:
  void SetUp() override {
    if (GetParam() > best_isa())
      GTEST_SKIP() << "this processor has no such instructions";
  }
  const Kernels& k = table(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Isa, ImageKernels, testing::Values(Isa::v2, Isa::v3, Isa::v4),
                         [](const auto& i) { return name(i.param); });

std::vector<std::uint16_t> all_halves() {
  std::vector<std::uint16_t> h(65536);
  for (int i = 0; i < 65536; ++i) h[i] = static_cast<std::uint16_t>(i);
  return h;
}

TEST_P(ImageKernels, EveryHalfBecomesTheFloatOfItsDefinition) {
  const auto halves = all_halves();
  std::vector<float> floats(65536);
  k.float_from_half(reinterpret_cast<const std::uint8_t*>(halves.data()), floats.data(),
                    floats.size());
  for (int i = 0; i < 65536; ++i) {
    const int exponent = i >> 10 & 31, mantissa = i & 1023;
    const double sign = i & 0x8000 ? -1 : 1;
    if (exponent == 31 && mantissa) {
      std::uint32_t bits;
      std::memcpy(&bits, &floats[i], 4);
      EXPECT_EQ(bits, (i & 0x8000u) << 16 | 0x7f800000u | unsigned(mantissa) << 13) << i;
      continue;
    }
    const double v = exponent == 31  ? std::numeric_limits<double>::infinity()
                     : exponent == 0 ? std::ldexp(mantissa, -24)
                                     : std::ldexp(1024 + mantissa, exponent - 25);
    EXPECT_EQ(floats[i], sign * v) << i;
    EXPECT_EQ(std::signbit(floats[i]), sign < 0) << i;
  }
}

TEST_P(ImageKernels, HalfToFloatToHalfIsTheIdentity) {
  const auto halves = all_halves();
  std::vector<float> floats(65536);
  std::vector<std::uint16_t> back(65536);
  k.float_from_half(reinterpret_cast<const std::uint8_t*>(halves.data()), floats.data(),
                    floats.size());
  const std::size_t overflows = k.half_from_float(
      floats.data(), reinterpret_cast<std::uint8_t*>(back.data()), floats.size());
  EXPECT_EQ(halves, back);
  EXPECT_EQ(overflows, 0u);
}

TEST_P(ImageKernels, FloatRoundsToTheNearestHalfTiesToEven) {
  // Between every two neighbouring finite halves: the middle, and a float to either side.
  std::vector<float> in;
  std::vector<std::uint16_t> expected;
  for (int i = 0; i < 0x7bff; ++i) {
    auto value = [](int h) {
      const int e = h >> 10, m = h & 1023;
      return e == 0 ? std::ldexp(float(m), -24) : std::ldexp(float(1024 + m), e - 25);
    };
    const float middle = (value(i) + value(i + 1)) / 2;  // exact: 12 bits
    const int even = i % 2 ? i + 1 : i;
    for (const int sign : {0, 0x8000}) {
      const float s = sign ? -1.0f : 1.0f;
      in.push_back(s * middle), expected.push_back(std::uint16_t(even | sign));
      in.push_back(s * std::nextafter(middle, 0.0f));
      expected.push_back(std::uint16_t(i | sign));
      in.push_back(s * std::nextafter(middle, 1e9f));
      expected.push_back(std::uint16_t((i + 1) | sign));
    }
  }
  std::vector<std::uint16_t> out(in.size());
  EXPECT_EQ(k.half_from_float(in.data(), reinterpret_cast<std::uint8_t*>(out.data()),
                              in.size()),
            0u);
  EXPECT_EQ(out, expected);
}

TEST_P(ImageKernels, TooLargeBecomesTheLargestHalfAndIsCounted) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> in = {65504, 65505, -65520, 1e5f,   3e38f,
                                 inf,   -inf,  1,      -3e38f, 2};
  std::vector<std::uint16_t> out(in.size());
  const std::size_t n = k.half_from_float(
      in.data(), reinterpret_cast<std::uint8_t*>(out.data()), in.size());
  EXPECT_EQ(n, 5u);
  const std::vector<std::uint16_t> expected = {0x7bff, 0x7bff, 0xfbff, 0x7bff, 0x7bff,
                                               0x7c00, 0xfc00, 0x3c00, 0xfbff, 0x4000};
  EXPECT_EQ(out, expected);
}

TEST_P(ImageKernels, UintsRoundAndClamp) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> in = {
      0, -1, 0.49f, 0.5f, 7, 4294967040.0f, 4294967296.0f, inf, -inf, std::nanf("")};
  const std::vector<std::uint32_t> expected = {
      0, 0, 0, 1, 7, 4294967040u, 4294967295u, 4294967295u, 0, 0};
  std::vector<std::uint32_t> out(in.size());
  k.uint_from_float(in.data(), reinterpret_cast<std::uint8_t*>(out.data()), in.size());
  EXPECT_EQ(out, expected);
  const std::vector<std::uint32_t> u = {0, 1, 16777217, 4294967295u};
  std::vector<float> f(u.size());
  k.float_from_uint(reinterpret_cast<const std::uint8_t*>(u.data()), f.data(), u.size());
  for (std::size_t i = 0; i < u.size(); ++i) EXPECT_EQ(f[i], static_cast<float>(u[i]));
}

TEST_P(ImageKernels, PredictorIsItsDefinitionAndItsInverseForEveryLength) {
  std::mt19937 random(11);
  for (std::size_t n = 0; n < 300; ++n) {
    std::vector<std::uint8_t> pixels(n), packed(n), expected(n), back(n);
    for (auto& b : pixels) b = static_cast<std::uint8_t>(random());
    for (std::size_t i = 0; i < n; ++i)
      expected[i % 2 ? (n + 1) / 2 + i / 2 : i / 2] = pixels[i];
    for (std::size_t i = n; i-- > 1;)
      expected[i] = static_cast<std::uint8_t>(expected[i] - expected[i - 1] + 128);
    k.apply_predictor(pixels.data(), packed.data(), n);
    EXPECT_EQ(packed, expected) << n;
    k.undo_predictor(packed.data(), back.data(), n);
    EXPECT_EQ(back, pixels) << n;
  }
}

}  // namespace
}  // namespace brume::exr
