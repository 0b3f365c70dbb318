// Facts that hold whatever the media.

#include <gtest/gtest.h>

#include <cstring>

#include "support.h"

namespace brume {
namespace {

using namespace testing_air;

// Two to five media of all kinds around the eye.
World random_world(Random& r) {
  std::vector<brume_medium> media;
  const int n = 2 + r.integer(4);
  for (int i = 0; i < n; ++i) {
    brume_medium m = r.integer(2) ? height_fog(r.log(1e-4, 1e-1), r.log(1e-3, 1e-1),
                                               r.uniform(-50, 50), r.uniform(0, 1))
                                  : fog(r.log(1e-4, 1e-1), r.uniform(0, 1));
    if (r.integer(4) == 0) {
      m.profile = BRUME_LORENTZIAN;
      m.falloff = r.log(1e-4, 1);
      for (int c = 0; c < 3; ++c) {
        m.origin[c] = r.uniform(-50, 50);
        m.emission[c] = r.uniform(0, 0.01);
        if (i % 2) m.extinction[c] = 0;
      }
    }
    const int shape = r.integer(4);
    if (shape == 1)
      m = shaped(m, BRUME_HALF_SPACE, {0, 0, r.uniform(-20, 20)}, {1, 1, 1});
    if (shape > 1)
      m = shaped(m, shape == 2 ? BRUME_BOX : BRUME_ELLIPSOID,
                 {r.uniform(-60, 60), r.uniform(-60, 60), r.uniform(-30, 30)},
                 {r.log(1, 80), r.log(1, 80), r.log(1, 80)}, r.uniform(0, 3));
    media.push_back(m);
  }
  return world_of(media);
}

Bundle random_rays(Random& r, int n) {
  Bundle b;
  for (int i = 0; i < n; ++i) b.add(r.direction(), r.integer(8) ? r.log(1, 1e3) : kInf);
  return b;
}

bool same_bits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST(Laws, ARaysBitsDependOnNothingButItself) {
  const unsigned seed = 3;
  RecordProperty("seed", int(seed));
  for (Isa isa : isas()) {
    Random random(seed);
    for (int scene = 0; scene < 60; ++scene) {
      World w = random_world(random);
      AirOptions o = options();
      o.isa = isa;
      const Air air = Air::compile(w, o);
      const Bundle all = random_rays(random, 300);
      const Result whole = integrate(air, all);
      const Result with_shares = integrate(air, all, 6);
      for (int i = 0; i < all.size(); i += 7) {
        Bundle one;
        for (int c = 0; c < 3; ++c) {
          one.d[c] = {all.d[c][i]};
          one.o[c] = {0};
        }
        one.end = {all.end[i]};
        const Result r = integrate(air, one);
        for (int c = 0; c < 3; ++c) {
          ASSERT_TRUE(same_bits(r.T[c][0], whole.T[c][i])) << scene << " " << i;
          ASSERT_TRUE(same_bits(r.L[c][0], whole.L[c][i]))
              << scene << " " << i << " " << r.L[c][0] << " " << whole.L[c][i];
          ASSERT_TRUE(same_bits(with_shares.L[c][i], whole.L[c][i])) << scene << " " << i;
        }
      }
    }
  }
}

TEST(Laws, ARowMeetsOfManySmallMediaThoseThatItsRaysMeet) {
  // Rays of a row, from the eye, leave out what their cone does not meet, part by part of
  // the row; the same rays with an origin leave nothing out.
  Random random(5);
  int met = 0;
  for (int scene = 0; scene < 40; ++scene) {
    std::vector<brume_medium> media;
    for (int i = 0; i < 150; ++i) {
      const double size = random.log(.02, 3);
      media.push_back(
          shaped(fog(random.log(.1, 3) / size, random.uniform(0, 1)),
                 i % 2 ? BRUME_BOX : BRUME_ELLIPSOID,
                 {random.uniform(-30, 30), random.uniform(10, 60), random.uniform(-8, 8)},
                 {size, size * random.uniform(.2, 3), size}, random.uniform(0, 3)));
    }
    const World w = world_of(media);
    Bundle row, placed;
    const double tilt = random.uniform(-.2, .2), lean = random.uniform(-.3, .3);
    for (int i = 0; i < 256; ++i) {
      const double u = (i - 128) / 300.;
      const glm::dvec3 d(u, 1, tilt + lean * u);
      const double end = random.integer(4) ? random.uniform(5, 80) : kInf;
      row.add(d, end);
      placed.add({0, 0, 0}, d, end);
    }
    for (Isa isa : isas()) {
      AirOptions o = options();
      o.isa = isa;
      const Air air = Air::compile(w, o);
      const Result a = integrate(air, row), b = integrate(air, placed);
      const Result shares = integrate(air, row, 150);
      for (int i = 0; i < row.size(); ++i)
        for (int c = 0; c < 3; ++c) {
          const std::size_t k = std::size_t(i);
          // Where boundaries lie at a grazing ray's rounding: 1e-4 of a small medium.
          ASSERT_NEAR(a.T[c][k], b.T[c][k], 2e-3) << scene << ", " << i;
          ASSERT_NEAR(a.L[c][k], b.L[c][k], 2e-3) << scene << ", " << i;
          ASSERT_TRUE(same_bits(a.T[c][k], shares.T[c][k]));
          ASSERT_TRUE(same_bits(a.L[c][k], shares.L[c][k]));
          met += c == 0 && a.T[c][k] < .99f;
        }
    }
  }
  EXPECT_GE(met, 1000);
}

TEST(Laws, OrderOfStagesDoesNotChangeABit) {
  const unsigned seed = 4;
  RecordProperty("seed", int(seed));
  Random random(seed);
  for (int scene = 0; scene < 60; ++scene) {
    World w = random_world(random);
    World turned = w;
    std::reverse(turned.media.begin(), turned.media.end());
    const Bundle b = random_rays(random, 64);
    const Result x = integrate(Air::compile(w, options()), b);
    const Result y = integrate(Air::compile(turned, options()), b);
    for (int i = 0; i < b.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        ASSERT_TRUE(same_bits(x.T[c][i], y.T[c][i]));
        ASSERT_TRUE(same_bits(x.L[c][i], y.L[c][i]));
      }
  }
}

TEST(Laws, NothingOnTheRayIsExactlyNothing) {
  // A ray that misses everything, next to rays that do not.
  const World w = world_of({shaped(fog(1, 1), BRUME_BOX, {0, 0, 10}, {1, 1, 1}),
                            shaped(fog(2, .5), BRUME_ELLIPSOID, {0, 0, 10}, {2, 1, 1})});
  const Air air = Air::compile(w, options());
  Bundle b;
  b.add({0, 0, 1}, 100);
  b.add({0, 1, 0}, 100);
  b.add({0, 0, 1}, 8);
  const Result r = integrate(air, b);
  EXPECT_LT(r.T[0][0], 1);
  for (int i : {1, 2})
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(r.T[c][i], 1);
      EXPECT_EQ(r.L[c][i], 0);
      EXPECT_FALSE(std::signbit(r.L[c][i]));
    }
}

TEST(Laws, TwoStretchesComposeToTheWhole) {
  const unsigned seed = 6;
  RecordProperty("seed", int(seed));
  Random random(seed);
  for (int scene = 0; scene < 100; ++scene) {
    const World w = random_world(random);
    const Air air = Air::compile(w, options(16, 1e-4));
    Bundle whole, near, rest;
    for (int i = 0; i < 32; ++i) {
      const glm::dvec3 d = random.direction();
      const double t = random.log(1, 1e3), cut = t * random.uniform(0, 1);
      whole.add(d, t);
      near.add(d, cut);
      rest.add(cut * d, d, t - cut);
    }
    const Result x = integrate(air, whole), y = integrate(air, near),
                 z = integrate(air, rest);
    for (int i = 0; i < whole.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        // T: exponents up to 100 rounded at eps, at most e^-1 of it. L: the tolerance of
        // either side, 1e-4 (1 + |L|).
        ASSERT_NEAR(x.T[c][i], y.T[c][i] * z.T[c][i], 1e-5);
        ASSERT_NEAR(x.L[c][i], y.L[c][i] + y.T[c][i] * z.L[c][i], 3e-4 * (1 + x.L[c][i]))
            << scene << " " << i;
      }
  }
}

TEST(Laws, TInZeroOneAndLNoMoreThanTheLargestSource) {
  const unsigned seed = 7;
  RecordProperty("seed", int(seed));
  Random random(seed);
  for (int scene = 0; scene < 200; ++scene) {
    World w = random_world(random);
    for (auto& p : w.media) {
      const double stiff = random.log(1e-3, 1e9);
      for (int c = 0; c < 3; ++c) {
        p.what.extinction[c] *= stiff;
        p.what.emission[c] = 0;
      }
    }
    const Air air = Air::compile(w, options());
    const Bundle b = random_rays(random, 64);
    const Result r = integrate(air, b);
    for (int i = 0; i < b.size(); ++i) {
      const double T = r.T[0][i], L = r.L[0][i];
      ASSERT_TRUE(T >= 0 && T <= 1) << scene << " " << i;
      // Sources are below 1; 1e-5 for the rounding of a few hundred pieces.
      ASSERT_TRUE(L >= 0 && L <= (1 - T) * (1 + 1e-5) + 1e-6) << L << " " << T;
    }
  }
}

TEST(Laws, SharesAddUpAndMultiply) {
  const unsigned seed = 8;
  RecordProperty("seed", int(seed));
  Random random(seed);
  for (int scene = 0; scene < 60; ++scene) {
    const World w = random_world(random);
    const int stages = int(w.media.size());
    const Air air = Air::compile(w, options(stages));
    const Bundle b = random_rays(random, 48);
    const Result r = integrate(air, b, stages);
    for (int i = 0; i < b.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        double L = 0, T = 1;
        for (int s = 0; s < stages; ++s) {
          L += r.stage_L[3 * s + c][i];
          T *= r.stage_T[3 * s + c][i];
        }
        ASSERT_NEAR(T, r.T[c][i], 1e-6);
        // Rounding of up to a hundred pieces.
        ASSERT_NEAR(L, r.L[c][i], 1e-5 * (1 + r.L[c][i])) << scene << " " << i;
      }
  }
}

TEST(Laws, ScaleOfTheWorldDoesNotMatter) {
  const unsigned seed = 9;
  RecordProperty("seed", int(seed));
  Random random(seed);
  for (int scene = 0; scene < 60; ++scene) {
    const World w = random_world(random);
    const double s = std::exp2(random.integer(40) - 20);  // exact in float
    World scaled = w;
    for (auto& p : scaled.media) {
      for (int c = 0; c < 3; ++c) {
        p.what.extinction[c] /= s;
        p.what.emission[c] /= s;
        p.what.origin[c] *= s;
        for (int j = 0; j < 3; ++j) p.what.local_from_world[4 * c + j] /= s;
      }
      p.what.falloff /= p.what.profile == BRUME_LORENTZIAN ? s * s : s;
    }
    Bundle b = random_rays(random, 32), bs = b;
    for (float& t : bs.end) t *= float(s);
    const Result x = integrate(Air::compile(w, options()), b);
    const Result y = integrate(Air::compile(scaled, options()), bs);
    for (int i = 0; i < b.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(x.T[c][i], y.T[c][i], 1e-5) << s;
        ASSERT_NEAR(x.L[c][i], y.L[c][i], 1e-3 * (1 + x.L[c][i])) << s;
      }
  }
}

TEST(Laws, WeightsScaleAStageAlongTheRay) {
  const World w = world_of(
      {fog(0.02, 1), shaped(fog(0.05, .2), BRUME_BOX, {0, 0, 50}, {30, 30, 25})});
  const World half = world_of({fog(0.01, 1), w.media[1].what});
  Bundle b;
  for (int i = 0; i < 20; ++i) b.add({0.01 * i, 0, 1}, 10 * i);
  const std::vector<float> weight(20, 0.5f), none(20, 0.f);
  const float* ws[] = {weight.data(), nullptr};
  const Result x = integrate(Air::compile(w, options(2)), b, 0, ws);
  const Result y = integrate(Air::compile(half, options(2)), b);
  for (int i = 0; i < 20; ++i) {
    EXPECT_NEAR(x.T[0][i], y.T[0][i], 1e-6);
    EXPECT_NEAR(x.L[0][i], y.L[0][i], 1e-5);
  }
  const float* off[] = {none.data(), none.data()};
  const Result z = integrate(Air::compile(w, options(2)), b, 0, off);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(z.T[0][i], 1);
    EXPECT_EQ(z.L[0][i], 0);
  }
}

TEST(Laws, NonsenseIsRefusedByName) {
  const auto bad = [](auto change) {
    World w = world_of({fog(1, 1)});
    w.media[0].name = "mist";
    change(w.media[0].what);
    EXPECT_THROW(Air::compile(w, options()), std::runtime_error);
  };
  bad([](brume_medium& m) { m.extinction[0] = NAN; });
  bad([](brume_medium& m) { m.extinction[0] = -1; });
  bad([](brume_medium& m) { m.albedo[1] = 1.5; });
  bad([](brume_medium& m) { m.profile = BRUME_CUSTOM; });
  bad([](brume_medium& m) { m.source = BRUME_SOURCE_CUSTOM; });
  bad([](brume_medium& m) {
    m.shape = BRUME_BOX;
    m.local_from_world[0] = 0;
  });
}

}  // namespace
}  // namespace brume
