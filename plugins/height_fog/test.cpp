// Facts about height fog, asked of the product's own path: registry, module, stage,
// World, integrator. Its truth is oracle.cpp.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "../../tests/stage/generated.h"
#include "air/air.h"
#include "baseline.h"
#include "num/error.h"
#include "oracle.h"
#include "scene/scene_file.h"
#include "stage/instance.h"
#include "stage/registry.h"

namespace {

using namespace brume;
using height_fog::Fog;

constexpr double kInf = std::numeric_limits<double>::infinity();
// As long as a ray can be (README.md, "Limits"): the visible universe is 9e26 m wide.
constexpr double kForever = 1e30;
constexpr double kEps = std::numeric_limits<float>::epsilon();

// ---- the bounds, said once: asserted below, printed into the README
// --------------------- A float exponent x is off by eps |x| / 2 of itself; T = e^-tau is
// then off by at most (1/e) of tau's relative error, and 1 - T by all of it.
constexpr double kErrorT = 1e-6;        // absolute, plus eps |c dz| / e
constexpr double kErrorOpacity = 2e-6;  // of 1 - T, relative, plus eps |c dz|

struct Ray {
  float ox = 0, oy = 0, oz = 0, dx = 0, dy = 0, dz = 1, t = 0;
};
struct Answer {
  float T[3], L[3];
};

Ray climbing(double mu, double t) {
  return {.dx = float(std::sqrt((1 - mu) * (1 + mu))), .dz = float(mu), .t = float(t)};
}

// A fog in the world, made as the pipeline makes it.
class FogAir {
 public:
  explicit FogAir(const std::vector<std::pair<std::string, std::string>>& set,
                  const FrameInfo& frame, bool linked = false,
                  std::optional<Isa> isa = {}) {
    const StageType& type = registry(linked).find("height_fog");
    Settings s = Settings::defaults(type.specs);
    s.set("color", "1", {}, "height_fog");
    for (const auto& [name, value] : set) s.set(name, value, {}, "height_fog");
    instance_ =
        std::make_unique<StageInstance>(type, "height_fog", s.at(frame.frame), cache_);
    world_.eye = frame.eye;
    world_.up = frame.up;
    instance_->publish(frame, 0, world_);
    air_ = Air::compile(world_, {.tolerance = 1e-3, .white = 1, .stages = 1, .isa = isa});
  }

  std::vector<Answer> operator()(const std::vector<Ray>& rays) const {
    const std::size_t n = rays.size();
    std::vector<float> in(7 * n), out(6 * n);
    for (std::size_t i = 0; i < n; ++i) {
      const float v[7] = {rays[i].ox, rays[i].oy, rays[i].oz, rays[i].dx,
                          rays[i].dy, rays[i].dz, rays[i].t};
      for (std::size_t k = 0; k < 7; ++k) in[k * n + i] = v[k];
    }
    const auto plane = [&](std::vector<float>& v, std::size_t k) {
      return v.data() + k * n;
    };
    const RaySpans spans{int(n),       plane(in, 0), plane(in, 1), plane(in, 2),
                         plane(in, 3), plane(in, 4), plane(in, 5), plane(in, 6)};
    air_.integrate(spans, {},
                   {{plane(out, 0), plane(out, 1), plane(out, 2)},
                    {plane(out, 3), plane(out, 4), plane(out, 5)},
                    {},
                    {}});
    std::vector<Answer> answers(n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        answers[i].T[c] = out[c * n + i], answers[i].L[c] = out[(3 + c) * n + i];
    return answers;
  }
  Answer operator()(const Ray& r) const { return (*this)(std::vector<Ray>{r})[0]; }

  const World& world() const { return world_; }

  static Registry& registry(bool linked) {
    static Registry modules({.files = {}, .use_linked = false});
    static Registry inside({.files = {}, .use_environment = false, .use_trees = false});
    return linked ? inside : modules;
  }

 private:
  StageCache cache_;
  std::unique_ptr<StageInstance> instance_;
  World world_;
  Air air_;
};

std::string text(double x) {
  char t[40];
  std::snprintf(t, sizeof t, "%.17g", x);
  return t;
}

FrameInfo at(double z) {
  FrameInfo f;
  f.has_camera = true;
  f.eye = {0, 0, z};
  return f;
}

TEST(HeightFogOracle, AgreesWithTheClosedFormsThatExist) {
  const Fog uniform{.density = 0.5L};
  EXPECT_NEAR(double(optical_depth(uniform, 7, 0.3L, 2, 12) / 5), 1, 1e-14);
  const Fog fog{.density = 2, .height = 3, .falloff = 0.25L};
  // Straight up from its reference height to infinity: sigma / c. A level ray: sigma t.
  EXPECT_NEAR(double(optical_depth(fog, 3, 1, 0, kInf) / 8), 1, 1e-14);
  EXPECT_NEAR(double(optical_depth(fog, 3, 0, 0, 1e6L) / 2e6L), 1, 1e-14);
  EXPECT_EQ(optical_depth(fog, 3, -1, 0, kInf), HUGE_VALL);
  EXPECT_EQ(optical_depth(fog, 3, 0, 0, kInf), HUGE_VALL);
  // c dz = 1e4 both ways: only the thick end counts.
  const Fog steep{.density = 1, .falloff = 10};
  EXPECT_NEAR(double(optical_depth(steep, 0, 1, 0, 1000) * 10), 1, 1e-14);
  EXPECT_NEAR(double(optical_depth(steep, 1000, -1, 0, 1000) * 10), 1, 1e-14);
}

double length(const Ray& r) { return std::min<double>(r.t, kForever); }

// The largest excess over what the roundings below explain.
struct Worst {
  double T = 0, opacity = 0;
};

// Holds an answer of fog with colour 1, whose L is its opacity, against the truth.
void expect_near_truth(const Answer& got, double density, double tau, double c,
                       const Ray& ray, const std::string& where, Worst& worst) {
  const double T = std::exp(-tau), opacity = -std::expm1(-tau);
  // A float exponent. (Where the fog is so stiff that it says nothing, T is still in [0,
  // 1].)
  const double slack = kEps * std::min(1e7, std::abs(c * ray.dz * length(ray)));
  // A density that is below the normal floats everywhere on the ray has lost its digits.
  const double underflow = density * length(ray) * std::numeric_limits<float>::min();
  for (int k = 0; k < 3; ++k) {
    const double got_T = got.T[k], got_L = got.L[k];
    ASSERT_TRUE(got_T >= 0 && got_T <= 1 && got_L >= 0 && got_L <= 1)
        << where << ": T " << got_T << ", L " << got_L;
    if (slack >= 1) continue;  // c dz is beyond 1e7: a float says nothing of it
    const double error_T = std::abs(got_T - T) - slack / std::exp(1) - underflow;
    EXPECT_LE(error_T, kErrorT) << where << ": T " << got_T << ", not " << T;
    worst.T = std::max(worst.T, error_T);
    const double error = std::abs(got_L - opacity) - slack * opacity - underflow -
                         std::numeric_limits<float>::min();
    EXPECT_LE(error, kErrorOpacity * opacity)
        << where << ": opacity " << got_L << ", not " << opacity;
    if (error > 0) worst.opacity = std::max(worst.opacity, error / opacity);
  }
}

TEST(HeightFog, AgreesWithQuadratureOverTheStiffGrid) {
  const double falloffs[] = {0, 1e-9, 1e-5, 1e-3, 0.1, 10, 1e3};
  const double eyes[] = {-1e7, -300, -1, 0, 1.7, 1e3, 1e7};
  const double slopes[] = {-1,   -0.5, -0.01,  -1e-4,  -1e-9, 0,
                           1e-9, 1e-4, 0.0099, 0.0101, 0.5,   1};
  const double depths[] = {0, 1e-6, 0.1, 10, 1e3, 1e5, 1e9, kInf};
  const double densities[] = {0, 1e-6, 2e-3, 1, 1e6};
  std::vector<Ray> rays;
  for (const double mu : slopes)
    for (const double d : depths) rays.push_back(climbing(mu, d));
  Worst worst[3];
  for (const double c : falloffs)
    for (const double z : eyes) {
      std::vector<long double> tau;  // at density 1
      for (const Ray& r : rays)
        tau.push_back(height_fog::optical_depth({.density = 1, .falloff = c}, z, r.dz, 0,
                                                length(r)));
      for (const double density : densities)
        for (const Isa isa : {Isa::v2, Isa::v3, Isa::v4}) {
          if (isa > best_isa()) continue;
          const auto answers = FogAir({{"falloff", text(c)}, {"density", text(density)}},
                                      at(z), false, isa)(rays);
          for (std::size_t i = 0; i < rays.size(); ++i) {
            const Ray& r = rays[i];
            const std::string where = "falloff " + text(c) + ", eye " + text(z) +
                                      ", slope " + text(r.dz) + ", depth " + text(r.t) +
                                      ", density " + text(density) + ", " + name(isa);
            const double t = density == 0 ? 0 : double(density * tau[i]);
            expect_near_truth(answers[i], density, t, c, r, where, worst[int(isa)]);
            ASSERT_FALSE(HasFatalFailure()) << where;
          }
        }
    }
  for (const Isa isa : {Isa::v2, Isa::v3, Isa::v4})
    std::printf("%s: beyond the exponent's rounding |dT| <= %.1e, of 1-T <= %.1e\n",
                name(isa), worst[int(isa)].T, worst[int(isa)].opacity);
}

TEST(HeightFog, AgreesWithQuadratureWhereItIsNeitherClearNorOpaque) {
  // A grid seldom hits the optical depths that show an error. Here everything is random,
  // and the density such that the ray's optical depth is between 1e-3 and 10.
  const unsigned seed = 20061101;
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  const auto log_uniform = [&](double a, double b) {
    return std::exp(uniform(std::log(a), std::log(b)));
  };
  Worst worst;
  int asked = 0;
  for (int i = 0; i < 3000; ++i) {
    const double c = log_uniform(1e-6, 1e3);
    const double z =
        uniform(-60, 60) / c;  // density at the eye e^-60 to e^60 of that at 0
    if (std::abs(z) > 1e7) continue;
    const double mu = uniform(0, 1) < 0.2 ? uniform(-1e-6, 1e-6) : uniform(-1, 1);
    const Ray ray = climbing(mu, log_uniform(1e-3, 1e7));
    const double unit = double(
        height_fog::optical_depth({.density = 1, .falloff = c}, z, ray.dz, 0, ray.t));
    const double density = log_uniform(1e-3, 10) / unit;
    if (!(density > 0 && density <= 1e6) || std::abs(c * ray.dz * ray.t) > 1e4) continue;
    const Answer got =
        FogAir({{"falloff", text(c)}, {"density", text(density)}}, at(z))(ray);
    expect_near_truth(got, density, density * unit, c, ray,
                      "seed " + std::to_string(seed) + ", case " + std::to_string(i) +
                          ", falloff " + text(c) + ", eye " + text(z) + ", slope " +
                          text(ray.dz) + ", depth " + text(ray.t),
                      worst);
    ++asked;
  }
  EXPECT_GT(asked, 500);
  std::printf(
      "%d cases, seed %u: beyond the exponent's rounding |dT| <= %.1e, of 1-T <= %.1e\n",
      asked, seed, worst.T, worst.opacity);
}

TEST(HeightFog, AHorizontalRaySeesConstantDensity) {
  // Eye 50 m over the reference height, c = 0.02: density there is sigma / e, exactly
  // level.
  const FogAir fog({{"density", "0.01"}, {"falloff", "0.02"}}, at(50));
  for (const double d : {1.0, 100.0, 1000.0}) {
    const double tau = 0.01 * std::exp(-1.0) * d;
    EXPECT_NEAR(fog(climbing(0, d)).T[0], std::exp(-tau), kErrorT) << d;
  }
}

TEST(HeightFog, HasItsDensityAtItsHeight) {
  const std::vector<std::pair<std::string, std::string>> set = {
      {"density", "0.01"}, {"falloff", "0.02"}, {"height", "120"}};
  const double tau = 0.01 * 70;  // along a level ray of 70 m
  EXPECT_NEAR(FogAir(set, at(120))(climbing(0, 70)).T[0], std::exp(-tau), kErrorT);
  EXPECT_NEAR(FogAir(set, at(170))(climbing(0, 70)).T[0], std::exp(-tau / std::exp(1)),
              kErrorT);  // 1 / falloff higher: e times thinner
}

TEST(HeightFog, LookingUpThroughAllOfItSeesWhatIsAboveTheEye) {
  // tau = sigma(eye) / (c mu) to infinity.
  const FogAir fog({{"density", "0.004"}, {"falloff", "0.01"}}, at(0));
  for (const double mu : {1.0, 0.5, 0.1, 0.01})
    EXPECT_NEAR(fog(climbing(mu, kInf)).T[0], std::exp(-0.4 / float(mu)), kErrorT) << mu;
}

TEST(HeightFog, LookingDownOrAlongForeverSeesNothing) {
  const FogAir fog({{"density", "1e-6"}, {"falloff", "1e-6"}, {"color", "0.25,0.5,1"}},
                   at(1e3));
  for (const double mu : {-1.0, -1e-3, 0.0}) {
    const Answer a = fog(climbing(mu, kInf));
    EXPECT_EQ(a.T[0], 0) << mu;
    EXPECT_EQ(a.L[0], 0.25f) << mu;
    EXPECT_EQ(a.L[2], 1) << mu;
  }
}

TEST(HeightFog, NoDistanceIsNoFog) {
  const FogAir fog({{"density", "1e6"}, {"falloff", "1000"}}, at(-1e7));
  for (const double mu : {-1.0, 0.0, 1.0}) {
    const Answer a = fog(climbing(mu, 0));
    EXPECT_EQ(a.T[1], 1) << mu;
    EXPECT_EQ(a.L[1], 0) << mu;
  }
}

TEST(HeightFog, ThereIsNoThresholdOfSlope) {
  // Rays to points 1 km away, from 30 m below to 30 m above the eye in steps of 1 mm of
  // height: the transmittance must fall like its own derivative, never by a step. The
  // 2007 listing has one at dz = 0.01 m.
  const double b = 0.02, c = 10, d = 1000;
  const FogAir fog({{"density", text(b)}, {"falloff", text(c)}}, at(0.5));
  const double step = 1e-3;
  std::vector<Ray> rays;
  std::vector<double> theirs;
  for (double dz = -0.05; dz < 0.05; dz += step) {
    rays.push_back(climbing(dz / d, d));
    theirs.push_back(height_fog::baseline::transmittance(float(d), 0, float(dz), 0.5f,
                                                         float(b), float(c)));
  }
  const auto ours = fog(rays);
  double our_step = 0, their_step = 0, true_step = 0;
  const Fog truth{.density = b, .falloff = c};
  for (std::size_t i = 2; i < rays.size(); ++i) {
    const auto T = [&](std::size_t k) {
      return double(std::exp(-optical_depth(truth, 0.5L, rays[k].dz, 0, rays[k].t)));
    };
    // Second differences: 0 for a straight line, the step itself for a step.
    const auto bend = [](double x, double y, double z) {
      return std::abs(x - 2 * y + z);
    };
    our_step = std::max(our_step, bend(ours[i].T[0], ours[i - 1].T[0], ours[i - 2].T[0]));
    their_step = std::max(their_step, bend(theirs[i], theirs[i - 1], theirs[i - 2]));
    true_step = std::max(true_step, bend(T(i), T(i - 1), T(i - 2)));
  }
  EXPECT_LE(our_step, true_step + 4 * kErrorT);  // three values, the middle one twice
  // tau = b e^-5 d = 0.135; the limit is off by c dz / 2 = 5 % of it: T by 0.0059.
  EXPECT_GT(their_step, 0.004);
}

TEST(HeightFog, ItsBaselineIsTheListing) {
  const StageType& type = FogAir::registry(false).find("height_fog");
  EXPECT_NE(type.baseline, "");
  StageCache cache;
  Settings s = Settings::defaults(type.specs);
  for (const auto& [name, value] :
       {std::pair{"density", "0.1,0.2,0.4"}, {"height", "2"}, {"falloff", "0.5"}})
    s.set(name, value, {}, "height_fog");
  const auto ask = [&](float mu, float t, Answer& a) {
    StageInstance fog(type, "height_fog", s.at(0), cache);
    World world;
    fog.publish(at(3), 0, world);
    const float dx = std::sqrt(1 - mu * mu), none = 0;
    float* const L[3] = {&a.L[0], &a.L[1], &a.L[2]};
    float* const T[3] = {&a.T[0], &a.T[1], &a.T[2]};
    fog.baseline({1, nullptr, nullptr, nullptr, &dx, &none, &mu}, &t, L, T);
  };
  Answer a;
  ask(0.6f, 10, a);
  EXPECT_NEAR(a.T[1], height_fog::baseline::transmittance(8, 0, 6, 1, 0.2f, 0.5f), 1e-6);
  EXPECT_NEAR(a.L[1], 0.6 * (1 - a.T[1]), 1e-6);  // the default colour's green
  s.set("color", "sky", {}, "height_fog");
  EXPECT_THROW(ask(0.6f, 10, a), Error);
}

TEST(HeightFog, AThinFalloffKeepsItsDigits) {
  // c = 1e-5 1/m, a point 0.02 m above the eye: phi = 1 - 1e-7. The 2007 listing takes
  // 1 - exp(-2e-7) in float, where neighbouring numbers below 1 are 6e-8 apart.
  const double b = 0.001, c = 1e-5, d = 1000;
  const FogAir fog({{"density", text(b)}, {"falloff", text(c)}}, at(0));
  const double T = std::exp(-b * d);
  EXPECT_NEAR(fog(climbing(0.02 / d, d)).T[0], T, kErrorT);
  const double theirs =
      height_fog::baseline::transmittance(float(d), 0, 0.02f, 0, float(b), float(c));
  EXPECT_GT(std::abs(-std::log(theirs) / (b * d) - 1), 0.1);
}

TEST(HeightFog, TransmittanceOfAPathIsTheProductOfItsParts) {
  const FogAir fog({{"density", "0.01,0.02,0.04"}, {"falloff", "0.05"}}, at(20));
  std::mt19937 random(20070305);  // seed
  std::uniform_real_distribution<double> slope(-1, 1), length(0, 100);
  for (int i = 0; i < 500; ++i) {
    const Ray whole = climbing(slope(random), length(random));
    const float b = float(length(random) / 100) * whole.t;
    Ray first = whole, second = whole;
    first.t = b;
    second.t = whole.t - b;
    second.ox = b * whole.dx;
    second.oz = b * whole.dz;
    const Answer w = fog(whole), f = fog(first), s = fog(second);
    for (int k = 0; k < 3;
         ++k)  // three errors of T, each at most kErrorT, and two exponents
      EXPECT_NEAR(f.T[k] * s.T[k], w.T[k], 3 * kErrorT + 2 * kEps * 5) << i;
  }
}

TEST(HeightFog, WithFalloffTowardsZeroItBecomesUniform) {
  const FogAir uniform({{"density", "0.003"}, {"falloff", "0"}}, at(10));
  const FogAir nearly({{"density", "0.003"}, {"falloff", "1e-12"}}, at(10));
  EXPECT_EQ(uniform.world().media[0].what.profile, BRUME_UNIFORM);
  for (const double mu : {-1.0, 0.0, 0.7})
    for (const double d : {1.0, 300.0, 1e5})
      EXPECT_NEAR(uniform(climbing(mu, d)).T[0], nearly(climbing(mu, d)).T[0],
                  2 * kErrorT);
}

TEST(HeightFog, LIsItsColourTimesItsOpacity) {
  const FogAir fog({{"density", "0.01,0.02,0.04"}, {"color", "0.2,0.5,4"}}, at(5));
  const double color[3] = {0.2, 0.5, 4};
  for (const double d : {0.5, 20.0, 1e4}) {
    const Answer a = fog(climbing(0.2, d));
    for (int k = 0; k < 3; ++k)  // 1 - T of a T that is itself rounded: kErrorT each
      EXPECT_NEAR(a.L[k], color[k] * (1 - a.T[k]), 2 * kErrorT * color[k]);
  }
}

TEST(HeightFog, EndsWhereItHidesMaxOpacityInEveryChannel) {
  const double m = 0.7;
  const FogAir full({{"density", "0.001,0.01,0.1"}}, at(5));
  const FogAir ends({{"density", "0.001,0.01,0.1"}, {"max_opacity", text(m)}}, at(5));
  for (const double mu : {-0.1, 0.0, 0.3})
    for (const double d : {0.0, 1.0, 30.0, 1e3, 1e5, kInf}) {
      const Answer f = full(climbing(mu, d)), e = ends(climbing(mu, d));
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(e.T[k], std::max<double>(f.T[k], 1 - m), 2 * kErrorT)
            << mu << " " << d;
        EXPECT_NEAR(e.L[k], std::min<double>(f.L[k], m), 2 * kErrorT) << mu << " " << d;
      }
    }
}

TEST(HeightFog, StartIsABoundaryNotAFade) {
  const FogAir fog({{"density", "0.02"}, {"falloff", "0.01"}, {"start", "50"}}, at(5));
  const Fog truth{.density = 0.02L, .falloff = 0.01L, .start = 50};
  for (const double mu : {-0.5, 0.0, 0.5})
    for (const double d : {10.0, 50.0, 50.5, 200.0, 1e4}) {
      const Ray r = climbing(mu, d);
      const Answer a = fog(r);
      EXPECT_NEAR(a.T[0], double(std::exp(-seen(truth, 5, r.dz, r.t))), kErrorT);
      if (d <= 50) {
        EXPECT_EQ(a.T[0], 1);
        EXPECT_EQ(a.L[0], 0);
      }
    }
}

TEST(HeightFog, ScalesWithTheWorld) {
  // Lengths times 2^k, everything per metre divided by it: the same bits.
  const FogAir small({{"density", "0.5"}, {"falloff", "0.25"}, {"height", "2"}}, at(3));
  const FogAir large({{"density", text(0.5 / 1024)},
                      {"falloff", text(0.25 / 1024)},
                      {"height", text(2 * 1024)}},
                     at(3 * 1024));
  for (const double mu : {-1.0, -0.01, 0.0, 0.3})
    for (const double d : {0.125, 1.0, 13.0}) {
      const Ray r = climbing(mu, d);
      Ray far = r;
      far.t *= 1024;
      EXPECT_EQ(small(r).T[0], large(far).T[0]) << mu << " " << d;
      EXPECT_EQ(small(r).L[0], large(far).L[0]) << mu << " " << d;
    }
}

TEST(HeightFog, FollowsTheWorldsUp) {
  FrameInfo y_up = at(0);
  y_up.up = {0, 1, 0};
  y_up.eye = {0, 12, 0};
  const FogAir z({{"falloff", "0.1"}, {"density", "0.05"}, {"height", "4"}}, at(12));
  const FogAir y({{"falloff", "0.1"}, {"density", "0.05"}, {"height", "4"}}, y_up);
  for (const double mu : {-0.9, -0.1, 0.0, 0.6}) {
    const Ray r = climbing(mu, 40);
    Ray turned = r;
    std::swap(turned.dy, turned.dz);
    EXPECT_NEAR(z(r).T[0], y(turned).T[0], 2 * kErrorT) << mu;
  }
}

TEST(HeightFog, EyeTenThousandKilometresAwaySeesTheSameLayer) {
  // Straight down from 1e7 m onto the ground at 0 through all of it: sigma / c. The depth
  // is a float and says where the ground is to +- 0.5 m; c = 1e-3 keeps what that does
  // small.
  const FogAir fog({{"density", "0.001"}, {"falloff", "0.001"}}, at(1e7));
  const double c_dz = 1e4;
  EXPECT_NEAR(fog(climbing(-1, 1e7)).T[0], std::exp(-1.0),
              kErrorT + kEps * c_dz / std::exp(1));
}

TEST(HeightFog, HasNothingToDoWithoutDensityOrOpacity) {
  const StageType& type = FogAir::registry(false).find("height_fog");
  StageCache cache;
  const auto idle = [&](const char* name, const char* value) {
    Settings s = Settings::defaults(type.specs);
    s.set(name, value, {}, "height_fog");
    return StageInstance(type, "height_fog", s.at(0), cache).needs({}).idle;
  };
  EXPECT_EQ(idle("density", "0"), "density is 0");
  EXPECT_EQ(idle("max_opacity", "0"), "max_opacity is 0");
  EXPECT_EQ(idle("density", "0,0,1e-30"), "");
}

TEST(HeightFog, OnlyUniformFogDoesWithoutACamera) {
  const StageType& type = FogAir::registry(false).find("height_fog");
  StageCache cache;
  Settings s = Settings::defaults(type.specs);
  EXPECT_TRUE(StageInstance(type, "height_fog", s.at(0), cache).needs({}).camera);
  s.set("falloff", "0", {}, "height_fog");
  s.set("start", "12", {}, "height_fog");
  const StageNeeds n = StageInstance(type, "height_fog", s.at(0), cache).needs({});
  EXPECT_FALSE(n.camera);
  EXPECT_TRUE(n.depth);
  EXPECT_EQ(n.nearest, 12);
}

TEST(HeightFog, AsModuleAndLinkedInItGivesTheSameBits) {
  const std::vector<std::pair<std::string, std::string>> set = {
      {"density", "0.001,0.02,0.3"}, {"height", "12"},  {"falloff", "0.07"},
      {"color", "0.1,0.2,0.3"},      {"albedo", "0.5"}, {"g", "0.3"},
      {"max_opacity", "0.9"},        {"start", "3"}};
  const FogAir module(set, at(30), false), linked(set, at(30), true);
  EXPECT_NE(FogAir::registry(false).find("height_fog").from,
            FogAir::registry(true).find("height_fog").from);
  const brume_medium &a = module.world().media[0].what, &b = linked.world().media[0].what;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(a.extinction[i], b.extinction[i]);
    EXPECT_EQ(a.albedo[i], b.albedo[i]);
    EXPECT_EQ(a.color[i], b.color[i]);
    EXPECT_EQ(a.origin[i], b.origin[i]);
  }
  std::vector<Ray> rays;
  for (int i = 0; i < 200; ++i) rays.push_back(climbing(i / 100.0 - 1, i * i / 10.0));
  const auto x = module(rays), y = linked(rays);
  EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(Answer)), 0);
}

TEST(HeightFog, TakesItsSourceFromTheSkyWhenAsked) {
  const FogAir fog({{"color", "sky"}}, at(0));
  EXPECT_EQ(fog.world().media[0].what.source, BRUME_SOURCE_SKY);
}

TEST(HeightFog, ItsExampleIsAScene) {
  const SceneFile scene = read_scene(BRUME_SOURCE_DIR "/plugins/height_fog/example.toml",
                                     [](const std::string& type, const Location& where) {
                                       return FogAir::registry(false).specs(type, where);
                                     });
  ASSERT_EQ(scene.stages.size(), 1u);
  EXPECT_EQ(scene.stages[0].type, "height_fog");
}

TEST(HeightFog, ItsReadmeIsFresh) {
  const std::string file = "plugins/height_fog/README.md";
  test::expect_generated(file, "parameters",
                         markdown_table(FogAir::registry(false).specs("height_fog")));
  char rows[512];
  std::snprintf(rows, sizeof rows,
                "| of | bound |\n|---|---|\n"
                "| T, absolute | %.0e + eps abs(c dz) / e |\n"
                "| 1 - T, relative | %.0e + eps abs(c dz) |\n",
                kErrorT, kErrorOpacity);
  test::expect_generated(file, "errors", rows);
}

}  // namespace
