// Media with mistakes that people make, published through functions of their own: each
// must break a law. And sound ones that must not.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <span>
#include <thread>

#include "stress/stress.h"

namespace brume::stress {
namespace {

brume_medium fog(double sigma, double source) {
  brume_medium m = {};
  m.size = sizeof m;
  m.name = "";
  m.shape = BRUME_EVERYWHERE;
  m.profile = BRUME_UNIFORM;
  m.source = BRUME_SOURCE_COLOR;
  m.direction[2] = 1;
  m.max_opacity = 1;
  for (const int i : {0, 5, 10}) m.local_from_world[i] = 1;
  for (int c = 0; c < 3; ++c) m.extinction[c] = sigma, m.color[c] = source;
  return m;
}

// Extinction and source for the functions of a medium.
struct Slab {
  float sigma = 1, source = 1;
};

template <class Make>
Report stress_of(Make&& make, double seconds = 60, std::uint64_t cases = 4096) {
  const Maker maker = [&](Random& r, const FrameInfo& frame) -> std::optional<Subject> {
    Subject s;
    s.world.eye = frame.eye;
    s.world.up = frame.up;
    make(r, s);
    return s;
  };
  return run("test", maker, {.cases = cases, .seed = 11, .seconds = seconds});
}

void publish(Subject& s, const brume_medium& m) { s.world.media.push_back({m, 0, "m"}); }

double magnitude(Random& r, double lo, double hi) {
  return lo * std::pow(hi / lo, r.uniform());
}

// Every answer of a medium by one formula of its optical depth.
template <class L, class T>
void alone(const void* self, const brume_rays* rays, const float* weights,
           const float* t0, const float* t1, float* const out_L[3], float* const out_T[3],
           L&& light, T&& through) {
  for (std::size_t i = 0; i < rays->n; ++i)
    for (int c = 0; c < 3; ++c) {
      Slab slab = *static_cast<const Slab*>(self);
      if (weights) slab.sigma *= weights[i];
      out_T[c][i] = through(slab, t1[i] - t0[i]);
      out_L[c][i] = light(slab, t1[i] - t0[i]);
    }
}

float beer(const Slab& s, float ds) { return std::exp(-s.sigma * ds); }

// L += T S ds with 16 equal steps.
void rectangle_rule(const void* self, const brume_rays* rays, const float* weights,
                    const float* t0, const float* t1, float* const L[3],
                    float* const T[3]) {
  alone(
      self, rays, weights, t0, t1, L, T,
      [](const Slab& s, float length) {
        float T_ = 1, sum = 0;
        const float ds = std::min(length, 1e6f) / 16;
        for (int k = 0; k < 16; ++k) {
          sum += T_ * s.source * s.sigma * ds;
          T_ *= std::exp(-s.sigma * ds);
        }
        return sum;
      },
      beer);
}

// (S - S e^-x) / max(sigma, 1e-5), S the light added per metre.
void clamped_sigma(const void* self, const brume_rays* rays, const float* weights,
                   const float* t0, const float* t1, float* const L[3],
                   float* const T[3]) {
  alone(
      self, rays, weights, t0, t1, L, T,
      [](const Slab& s, float length) {
        const float S = s.source * s.sigma;
        return (S - S * std::exp(-s.sigma * length)) / std::max(s.sigma, 1e-5f);
      },
      beer);
}

void right(const void* self, const brume_rays* rays, const float* weights,
           const float* t0, const float* t1, float* const L[3], float* const T[3]) {
  alone(
      self, rays, weights, t0, t1, L, T,
      [](const Slab& s, float length) {
        return -s.source * std::expm1(-s.sigma * length);
      },
      beer);
}

Report with_form(brume_alone_fn form, double lo, double hi, bool is_sky = false) {
  return stress_of([=](Random& r, Subject& s) {
    auto slab = std::make_shared<Slab>();
    slab->sigma = float(magnitude(r, lo, hi));
    brume_medium m = fog(slab->sigma, slab->source);
    m.alone = form;
    m.is_sky = is_sky;
    m.self = slab.get();
    publish(s, m);
    s.keep = slab;
  });
}

void print(const Report& r) {
  std::printf("seed %llu, %llu cases, %llu truths:", (unsigned long long)r.seed,
              (unsigned long long)r.cases, (unsigned long long)r.truths);
  for (int k = 0; k < kLaws; ++k)
    if (r.findings[std::size_t(k)].broken > 0)
      std::printf(" %s %llu", name(Law(k)),
                  (unsigned long long)r.findings[std::size_t(k)].broken);
  std::printf("\n");
}

TEST(Stress, ASoundFormBreaksNoLaw) {
  const Report r = with_form(right, 1e-7, 1e3);
  print(r);
  EXPECT_TRUE(r.ok());
  EXPECT_GE(r.cases, 2560u);
  EXPECT_GT(r.truths, 0u);
}

TEST(Stress, FindsTheRectangleRuleOnAStiffSlab) {
  const Report r = with_form(rectangle_rule, 1, 1e6);
  print(r);
  EXPECT_GT(r.of(Law::energy).broken, 0u);
  EXPECT_GT(r.of(Law::truth_L).broken, 0u);
}

TEST(Stress, FindsAnExtinctionClampedFromBelow) {
  const Report r = with_form(clamped_sigma, 1e-9, 1e-6);
  print(r);
  EXPECT_GT(r.of(Law::truth_L).broken, 0u);
  EXPECT_EQ(r.of(Law::range).broken, 0u);  // T is as it should be
}

// Right to the tolerance, 1e-3, but for steps of nearly that between directions; and but
// for ripples of half of it.
template <class Off>
void off_by(const void* self, const brume_rays* rays, const float* weights,
            const float* t0, const float* t1, float* const L[3], float* const T[3],
            Off&& off) {
  right(self, rays, weights, t0, t1, L, T);
  for (std::size_t i = 0; i < rays->n; ++i)
    for (int c = 0; c < 3; ++c) L[c][i] += off(rays->dx[i]);
}
void stepping(const void* self, const brume_rays* rays, const float* weights,
              const float* t0, const float* t1, float* const L[3], float* const T[3]) {
  off_by(self, rays, weights, t0, t1, L, T,
         [](float x) { return std::sin(40 * x) > 0 ? 9e-4f : 0; });
}
void rippling(const void* self, const brume_rays* rays, const float* weights,
              const float* t0, const float* t1, float* const L[3], float* const T[3]) {
  off_by(self, rays, weights, t0, t1, L, T,
         [](float x) { return 4.5e-4f * (1 + std::sin(1e3f * x)); });
}

TEST(Stress, FindsStepsWithinTheTolerance) {
  const Report r = with_form(stepping, 1e-3, 1e3);
  print(r);
  EXPECT_GT(r.of(Law::jump).broken, 0u);
  EXPECT_EQ(r.of(Law::truth_L).broken, 0u);
}

TEST(Stress, FindsThemInASky) {
  EXPECT_TRUE(with_form(right, 1e-7, 1e3, true).ok());
  const Report r = with_form(stepping, 1e-3, 1e3, true);
  print(r);
  EXPECT_GT(r.of(Law::jump).broken, 0u);
  EXPECT_GT(with_form(rectangle_rule, 1, 1e6, true).of(Law::truth_L).broken, 0u);
}

TEST(Stress, FindsRipplesWithinTheTolerance) {
  const Report r = with_form(rippling, 1e-3, 1e3);
  print(r);
  EXPECT_GT(r.of(Law::step).broken, 0u);
  EXPECT_EQ(r.of(Law::jump).broken, 0u);
  EXPECT_EQ(r.of(Law::truth_L).broken, 0u);
}

// A shell of air 100 m high around a planet, its chord by b^2 - c in float about a centre
// 6.4e6 m away: eps 4e13 m^2 is lost, a good part of the way.
struct Planet {
  static constexpr float radius = 6.4e6f, top = 6.4001e6f;
};

template <class F>
F chord(F oz, F dz, F rest2, F b_rest, F t, F top) {
  const F b = b_rest + oz * dz, c = rest2 + oz * oz - top * top, disc = b * b - c;
  if (!(disc > 0)) return 0;
  const F root = std::sqrt(disc), in = std::max(F(0), -b - root);
  return std::max(F(0), std::min(t, -b + root) - in);
}

void float_shell(const void*, const brume_rays* r, const float* t0, const float* t1,
                 float* D) {
  for (std::size_t i = 0; i < r->n; ++i) {
    const float x = r->ox ? r->ox[i] : 0, y = r->oy ? r->oy[i] : 0,
                z = (r->oz ? r->oz[i] : 0) + Planet::radius;
    const float b = x * r->dx[i] + y * r->dy[i];
    const auto up_to = [&](float t) {
      return chord<float>(z, r->dz[i], x * x + y * y, b, t, Planet::top);
    };
    D[i] = std::max(up_to(t1[i]) - up_to(t0[i]), 0.f);
  }
}

void length_of(const void*, const brume_rays* r, const float* t0, const float* t1,
               float* D) {
  for (std::size_t i = 0; i < r->n; ++i) D[i] = t1[i] - t0[i];
}

void shell_density(const void*, const brume_rays* r, const float*, float* rho) {
  for (std::size_t i = 0; i < r->n; ++i) rho[i] = 1;
}

void shell_point(const void*, const double x[3], const double[3], double* rho, double*) {
  const double z = x[2] + Planet::radius;
  *rho = std::sqrt(x[0] * x[0] + x[1] * x[1] + z * z) <= Planet::top;
}

TEST(Stress, FindsAPlanetInFloat) {
  const Report r = stress_of([](Random& random, Subject& s) {
    s.world.eye = {0, 0, 0};
    brume_medium m = fog(magnitude(random, 1e-5, 1e-2), 1);
    m.profile = BRUME_CUSTOM;
    m.integral = float_shell;
    m.density = shell_density;
    m.point = shell_point;
    publish(s, m);
  });
  print(r);
  EXPECT_GT(r.of(Law::truth_T).broken, 0u);
}

// Layers a millimetre apart, 1 + .9 sin(k height), and their integral in closed form. The
// terms of a height far away are floats to less than that.
struct Layers {
  static constexpr double k = 6e3;
  glm::dvec3 up{0};
  double error = 0;  ///< of rays that do not begin at the eye

  double at(double height) const { return 1 + .9 * std::sin(k * height); }
  double height(const brume_rays& r, std::size_t i, double t) const {
    const double o = r.ox ? up.x * r.ox[i] + up.y * r.oy[i] + up.z * r.oz[i] : 0;
    return o + t * (up.x * r.dx[i] + up.y * r.dy[i] + up.z * r.dz[i]);
  }
};

void layers_integral(const void* self, const brume_rays* r, const float* t0,
                     const float* t1, float* D) {
  const Layers& l = *static_cast<const Layers*>(self);
  for (std::size_t i = 0; i < r->n; ++i) {
    const double a = t0[i], b = std::min(t1[i], 1e30f);
    const double x = Layers::k * (l.height(*r, i, b) - l.height(*r, i, a)) / 2;
    const double sinc = x != 0 ? std::sin(x) / x : 1;
    const double mean = 1 + (l.at(l.height(*r, i, (a + b) / 2)) - 1) * sinc;
    D[i] = float((r->ox ? 1 + l.error : 1) * mean * (b - a));
  }
}

void layers_density(const void* self, const brume_rays* r, const float* t, float* rho) {
  const Layers& l = *static_cast<const Layers*>(self);
  for (std::size_t i = 0; i < r->n; ++i) rho[i] = float(l.at(l.height(*r, i, t[i])));
}

void layers_point(const void* self, const double x[3], const double[3], double* rho,
                  double*) {
  const Layers& l = *static_cast<const Layers*>(self);
  *rho = l.at(glm::dot(l.up, {x[0], x[1], x[2]}));
}

Report with_layers(double error) {
  return stress_of(
      [=](Random& random, Subject& s) {
        auto field = std::make_shared<Layers>();
        field->up = s.world.up;
        field->error = error;
        s.world.eye = {0, 0, 0};
        brume_medium m = fog(magnitude(random, 1e-7, 1), 1);
        m.profile = BRUME_CUSTOM;
        m.integral = layers_integral;
        m.density = layers_density;
        m.point = layers_point;
        m.self = field.get();
        publish(s, m);
        s.keep = field;
      },
      60, 7680);
}

TEST(Stress, DetailFinerThanPlacesAreKnownBreaksNoLaw) {
  const Report r = with_layers(0);
  print(r);
  EXPECT_TRUE(r.ok());
}

TEST(Stress, FindsDepthThatDependsOnWhereItIsAskedFrom) {
  const Report r = with_layers(.03);
  print(r);
  EXPECT_GT(r.of(Law::split).broken, 0u);
}

TEST(Stress, FogThinnerThanFloatsWithoutEndBreaksNoLaw) {
  // A level ray without end through fog that falls by e every millimetre: capped where
  // its density is a float, clear for kernels and capped in truth a little higher.
  const Report r = stress_of(
      [](Random& random, Subject& s) {
        s.world.eye = random.uniform(0.04, 0.09) * s.world.up;
        brume_medium m = fog(0.04, 1);
        m.profile = BRUME_EXPONENTIAL;
        for (int i = 0; i < 3; ++i) m.direction[i] = s.world.up[i];
        m.falloff = 1e3;
        m.max_opacity = 0.5;
        publish(s, m);
      },
      60, 81920);
  print(r);
  EXPECT_TRUE(r.ok());
  EXPECT_GT(r.of(Law::step).checked, 4000u);
}

// A right answer that takes its time, in every seventh world as much as `most` seconds.
struct Slow : Slab {
  double most = 0;
};

TEST(Stress, AWorldThatIsTooDearIsGivenUpAndCounted) {
  const auto begin = std::chrono::steady_clock::now();
  const Report r = stress_of(
      [](Random& random, Subject& s) {
        auto slow = std::make_shared<Slow>();
        slow->most = random.uniform() < 1. / 7 ? 0.05 : 0;
        brume_medium m = fog(1, 1);
        m.profile = BRUME_CUSTOM;
        m.integral = [](const void* self, const brume_rays* rays, const float* t0,
                        const float* t1, float* D) {
          std::this_thread::sleep_for(
              std::chrono::duration<double>(static_cast<const Slow*>(self)->most));
          length_of(self, rays, t0, t1, D);
        };
        m.density = shell_density;
        m.point = [](const void*, const double[3], const double[3], double* rho,
                     double*) { *rho = 1; };
        m.self = slow.get();
        publish(s, m);
        s.keep = slow;
      },
      4, 4096);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  print(r);
  EXPECT_LT(took.count(), 6);
  EXPECT_TRUE(r.ok());
  EXPECT_GE(r.given_up, 1u);
  EXPECT_EQ(r.first_given_up % kGroup, 0u);
  EXPECT_GT(r.cases, 512u);
}

TEST(Stress, WhatATruthDoesNotDecideIsCounted) {
  // Noise finer than any number of looks: no step can be held against its truth.
  const Report r = stress_of(
      [](Random&, Subject& s) {
        s.world.eye = {0, 0, 0};
        brume_medium m = fog(1, 1);
        m.profile = BRUME_CUSTOM;
        m.integral = length_of;
        m.density = shell_density;
        m.point = [](const void*, const double x[3], const double[3], double* rho,
                     double*) { *rho = 1 + std::sin(1e9 * (x[0] + x[1] + x[2])); };
        publish(s, m);
      },
      20, 1024);
  print(r);
  EXPECT_GT(r.undecided, 10u);
  EXPECT_GT(r.of(Law::step).undecided, 10u);
  EXPECT_GT(r.of(Law::truth_T).undecided, 10u);
}

TEST(Stress, AFiguresCaseComesBackByItsNumber) {
  const Maker maker = [](Random& r, const FrameInfo& frame) -> std::optional<Subject> {
    auto slab = std::make_shared<Slab>();
    slab->sigma = float(magnitude(r, 1, 1e6));
    Subject s;
    s.world.eye = frame.eye;
    brume_medium m = fog(slab->sigma, 1);
    m.alone = rectangle_rule;
    m.self = slab.get();
    publish(s, m);
    s.keep = slab;
    return s;
  };
  const Options o{.cases = 1280, .seed = 3, .seconds = 60};
  const Finding all = run("test", maker, o).of(Law::energy);
  Options one = o;
  one.only = all.worst_case;
  const Finding again = run("test", maker, one).of(Law::energy);
  EXPECT_EQ(again.worst_case, all.worst_case);
  EXPECT_EQ(again.got, all.got);
  EXPECT_EQ(again.worst, all.worst);
}

}  // namespace
}  // namespace brume::stress
