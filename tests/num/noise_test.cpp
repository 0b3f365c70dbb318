// Random numbers are random, and noise is smooth, bounded, periodic and the same for all.

#include "num/noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "functions.h"

namespace brume::test {
namespace {

constexpr std::uint64_t kSeed = 11;

TEST(Philox, PublishedTestVectors) {
  using A = std::array<std::uint32_t, 4>;
  // Random123, kat_vectors, philox4x32 10.
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}),
            (A{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}),
            (A{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(
      philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
      (A{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, IsUniform) {
  Random random(kSeed);
  constexpr int n = 1'000'000, bins = 100;
  double mean = 0;
  int count[bins] = {};
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform();
    ASSERT_TRUE(u >= 0 && u < 1);
    mean += u / n;
    ++count[static_cast<int>(u * bins)];
  }
  EXPECT_NEAR(mean, 0.5, 5 / std::sqrt(12.0 * n));  // 5 standard errors
  double chi2 = 0;
  for (const int c : count) chi2 += (c - n / bins) * double(c - n / bins) / (n / bins);
  EXPECT_NEAR(chi2, bins - 1, 5 * std::sqrt(2.0 * (bins - 1)));
}

TEST(Random, StreamsDiffer) {
  Random a(kSeed, 0), b(kSeed, 1), c(kSeed + 1, 0);
  int same = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto x = a.word();
    same += x == b.word();
    same += x == c.word();
  }
  EXPECT_LE(same, 1);
}

TEST(Hash, EveryInputBitFlipsHalfOfTheUpperOutputBits) {
  Random random(kSeed);
  constexpr int n = 1000;
  for (int word = 0; word < 4; ++word)
    for (int bit = 0; bit < 32; ++bit) {
      int flipped = 0;
      for (int i = 0; i < n; ++i) {
        std::uint32_t in[4] = {random.word(), random.word(), random.word(),
                               random.word()};
        const auto before = hash(in[0], in[1], in[2], in[3]);
        in[word] ^= 1u << bit;
        const auto after = hash(in[0], in[1], in[2], in[3]);
        flipped += std::popcount((before.x ^ after.x) >> 16);
      }
      // 16 n coins; the highest four input bits have less way to go and flip fewer.
      EXPECT_NEAR(flipped, 8 * n, (bit < 28 ? 0.05 : 0.3) * 8 * n) << word << " " << bit;
    }
}

TEST(Noise, IsZeroOnTheLatticeAndBounded) {
  Random random(kSeed);
  double largest = 0, mean = 0, square = 0;
  constexpr int n = 300'000;
  for (int i = 0; i < n; ++i) {
    const double x = random.uniform(-1e4, 1e4), y = random.uniform(-1e4, 1e4);
    const double z = random.uniform(-1e4, 1e4);
    const double v = noise(x, y, z);
    largest = std::max(largest, std::abs(v));
    mean += v / n;
    square += v * v / n;
    if (i < 1000) {
      EXPECT_EQ(noise(std::floor(x), std::floor(y), std::floor(z)), 0);
    }
  }
  EXPECT_LE(largest, 1.0364);
  EXPECT_NEAR(mean, 0, 5 * 0.27 / std::sqrt(n));  // 5 standard errors
  EXPECT_NEAR(std::sqrt(square), 0.27, 0.003);
}

TEST(Noise, StatedRangeIsTheLargestThatAnyGradientsGive) {
  // At each place the best gradient of each corner: the two longest components.
  const auto supremum = [](double x, double y, double z) {
    const double p[3] = {x, y, z};
    double total = 0;
    for (int c = 0; c < 8; ++c) {
      double weight = 1, d[3];
      for (int k = 0; k < 3; ++k) {
        const bool upper = c >> k & 1;
        const double t = upper ? 1 - p[k] : p[k];
        weight *= 1 - t * t * t * (t * (6 * t - 15) + 10);
        d[k] = t;
      }
      total += weight * (d[0] + d[1] + d[2] - std::min({d[0], d[1], d[2]}));
    }
    return total;
  };
  double largest = 0;
  for (int i = 0; i <= 100; ++i)
    for (int j = 0; j <= 100; ++j)
      for (int k = 0; k <= 100; ++k)
        largest = std::max(largest, supremum(0.005 * i, 0.005 * j, 0.005 * k));
  EXPECT_LE(largest, 1.0364);
  EXPECT_GE(largest, 1.0362);
}

TEST(Noise, HasTwoContinuousDerivativesAcrossCells) {
  // Value, slope and curvature from both sides of a lattice plane, by one-sided
  // differences with step h: they differ by O(h) of the next derivative, here at most 200
  // h.
  Random random(kSeed);
  constexpr double h = 1e-4;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 300; ++i) {
      double p[3] = {random.uniform(-50, 50), random.uniform(-50, 50),
                     random.uniform(-50, 50)};
      p[axis] = std::floor(p[axis]);
      const auto at = [&](double offset) {
        double q[3] = {p[0], p[1], p[2]};
        q[axis] += offset;
        return noise(q[0], q[1], q[2]);
      };
      const auto slope = [&](double s) { return s * (at(s * h) - at(0)) / h; };
      const auto curvature = [&](double s) {
        return (at(2 * s * h) - 2 * at(s * h) + at(0)) / (h * h);
      };
      EXPECT_NEAR(at(1e-9), at(-1e-9), 1e-8);
      EXPECT_NEAR(slope(1), slope(-1), 30 * h);
      EXPECT_NEAR(curvature(1), curvature(-1), 200 * h);
    }
}

TEST(Noise, RepeatsWithoutASeam) {
  Random random(kSeed);
  for (const int period : {1, 3, 5, 64}) {
    double seam = 0, inside = 0;
    for (int i = 0; i < 2000; ++i) {
      const double x = random.uniform(0, period), y = random.uniform(0, period);
      const double z = random.uniform(0, period);
      const double v = noise(x, y, z, 3, period);
      // x + period rounds to within 2^-46: slope 4 of it.
      EXPECT_NEAR(noise(x + period, y - 2 * period, z, 3, period), v, 1e-12);
      EXPECT_NEAR(noise(x, y, z + 100 * period, 3, period), v, 1e-11);
      const auto jump = [&](double at) {
        return std::abs(noise(at + 1e-3, y, z, 3, period) -
                        noise(at - 1e-3, y, z, 3, period));
      };
      seam = std::max(seam, jump(period));
      inside = std::max(inside, jump(std::floor(x)));
    }
    EXPECT_LE(seam, 1.1 * inside) << period;  // METHODS B11
  }
}

TEST(Noise, BatchAndFloatAndDoubleSeeOneWorld) {
  Random random(kSeed);
  constexpr int n = 4096;
  std::vector<float> x[3], batch(n), single(n);
  std::vector<double> wide[3], twice(n);
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < n; ++i) {
      x[k].push_back(static_cast<float>(random.uniform(-1000, 1000)));
      wide[k].push_back(x[k].back());
    }
  const float* in[] = {x[0].data(), x[1].data(), x[2].data()};
  const double* in_wide[] = {wide[0].data(), wide[1].data(), wide[2].data()};
  std::vector<const Functions*> tables = {&isa_host::functions, &isa_v2::functions};
  if (best_isa() >= Isa::v3) tables.push_back(&isa_v3::functions);
  if (best_isa() >= Isa::v4) tables.push_back(&isa_v4::functions);
  for (const Functions* table : tables)
    for (int f = 0; f < table->size; ++f) {
      const Function& noise = table->begin[f];
      if (std::string(noise.name).rfind("noise", 0) != 0) continue;
      noise.batch(in, batch.data(), n);
      noise.single(in, single.data(), n);
      noise.twice(in_wide, twice.data(), n);
      for (std::size_t i = 0; i < n; ++i) {
        // Some 40 roundings of numbers up to 1, 2^-25 each, if they all add up.
        ASSERT_NEAR(batch[i], single[i], 1.5e-6);
        ASSERT_NEAR(batch[i], twice[i], 1.5e-6);
      }
    }
}

TEST(Noise, NaNAndInfinityComeOutAsNaN) {
  EXPECT_TRUE(std::isnan(noise(float(NAN), 0.5f, 0.5f)));
  EXPECT_TRUE(std::isnan(noise(0.5f, INFINITY, 0.5f)));
  EXPECT_TRUE(std::isfinite(noise(3e38f, -3e38f, 1e20f, 1, 7)));
}

}  // namespace
}  // namespace brume::test
