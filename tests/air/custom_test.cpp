// Media and surfaces that answer for themselves, against pointwise double quadrature.

#include <gtest/gtest.h>

#include "support.h"

namespace brume {
namespace {

using namespace testing_air;

// A third party's medium: density 1 + sin(z/5)/2, its own integral and source.
struct Wave {
  static void integral(const void*, const brume_rays* r, const float* t0, const float* t1,
                       float* D) {
    for (size_t i = 0; i < r->n; ++i) {
      const double b = r->dz[i] / 5, a = (r->oz ? r->oz[i] : 0) / 5;
      const double s = std::abs(b) < 1e-9
                           ? std::sin(a) * (t1[i] - t0[i])
                           : (std::cos(a + b * t0[i]) - std::cos(a + b * t1[i])) / b;
      D[i] = float(t1[i] - t0[i] + s / 2);
    }
  }
  static void density(const void*, const brume_rays* r, const float* t, float* rho) {
    for (size_t i = 0; i < r->n; ++i)
      rho[i] = float(1 + std::sin(((r->oz ? r->oz[i] : 0) + r->dz[i] * t[i]) / 5.) / 2);
  }
  static void source(const void*, const brume_rays* r, const float* t, float* x, float* y,
                     float* z) {
    for (size_t i = 0; i < r->n; ++i) x[i] = y[i] = z[i] = float(std::exp(-t[i] * 0.02));
  }
  static void point(const void*, const double p[3], const double*, double* rho,
                    double S[3]) {
    *rho = 1 + std::sin(p[2] / 5) / 2;
    const double t = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int c = 0; c < 3; ++c) S[c] = std::exp(-t * 0.02);
  }
};

TEST(General, AMediumWithItsOwnFunctions) {
  brume_medium m = fog(0.03);
  m.profile = BRUME_CUSTOM;
  m.source = BRUME_SOURCE_CUSTOM;
  m.integral = Wave::integral;
  m.density = Wave::density;
  m.source_at = Wave::source;
  m.point = Wave::point;
  m = shaped(m, BRUME_BOX, {0, 0, 40}, {50, 50, 30});
  for (const World& w : {world_of({m}), world_of({m, height_fog(0.02, 0.05, 0, .5)})}) {
    const Air air = Air::compile(w, options());
    Bundle b;
    for (int i = 0; i < 20; ++i) b.add({0.1 * i, 0.02 * i, 1}, 100);
    const Result r = integrate(air, b);
    for (int i = 0; i < b.size(); ++i) {
      const auto truth = oracle::integrate(w, b.ray(i), 1e-7);
      EXPECT_NEAR(r.L[0][i], truth.L[0], 1e-3) << i;
      EXPECT_NEAR(r.T[0][i], truth.T[0], 2e-6) << i;
    }
  }
}

TEST(General, PiecesThatNeverAgreeLoseNoLight) {
  // A medium that is a fifth off, another way for every stretch it is asked for, in fog
  // of another colour: no piece is ever good, and after thousands of short ones there is
  // still most of the ray to go.
  brume_medium m = fog(0.003, 2);
  m.profile = BRUME_CUSTOM;
  m.integral = [](const void*, const brume_rays* r, const float* t0, const float* t1,
                  float* D) {
    for (std::size_t i = 0; i < r->n; ++i) {
      const double mixed = std::sin(1e4 * double(t0[i])) + std::sin(1e4 * double(t1[i]));
      D[i] = float((double(t1[i]) - double(t0[i])) * (1 + 0.1 * mixed));
    }
  };
  m.density = [](const void*, const brume_rays* r, const float*, float* rho) {
    for (std::size_t i = 0; i < r->n; ++i) rho[i] = 1;
  };
  const Air air = Air::compile(world_of({m, fog(0.001, 10)}), options(16, 1e-5));
  Bundle b;
  for (const double t : {30., 300., 3000., 3e5}) b.add({0, 0.6, 0.8}, t);
  const Result r = integrate(air, b);
  for (int i = 0; i < b.size(); ++i) {
    const double L = (2 * 0.003 + 10 * 0.001) / 0.004 * -std::expm1(-0.004 * b.end[i]);
    EXPECT_NEAR(r.L[0][i], L, 0.2 * L) << b.end[i];
  }
}

TEST(General, AMirrorInMidAirSplitsTheRay) {
  // A plane at z = -10 reflecting a quarter; uniform fog everywhere, black sky.
  brume_interface plane = {};
  plane.size = sizeof plane;
  plane.hit = [](const void*, const brume_rays* r, float* t, float* nx, float* ny,
                 float* nz, float* R) {
    for (size_t i = 0; i < r->n; ++i) {
      t[i] = r->dz[i] < 0 ? -10 / r->dz[i] : kInf;
      nx[i] = ny[i] = 0;
      nz[i] = 1;
      R[i] = 0.25f;
    }
  };
  brume_background sky = {};
  sky.size = sizeof sky;
  sky.radiance = [](const void*, const brume_rays* r, float* x, float* y, float* z) {
    for (size_t i = 0; i < r->n; ++i) x[i] = y[i] = z[i] = 8;
  };
  World w = world_of({shaped(fog(0.1, 1), BRUME_BOX, {0, 0, 0}, {1e3, 1e3, 50})});
  w.interfaces.push_back({plane, 0, ""});
  w.backgrounds.push_back({sky, 0, ""});
  const Air air = Air::compile(w, options());
  Bundle b;
  b.add({0, 0, -1}, 30);  // through the mirror
  b.add({0, 0, -1}, 5);   // ends before it
  b.add({0, 0, 1}, 30);   // away from it
  const Result r = integrate(air, b);
  const double T10 = std::exp(-1.), T20 = std::exp(-2.), T60 = std::exp(-6.);
  EXPECT_NEAR(r.T[0][0], T10 * 0.75 * T20, 1e-6);
  EXPECT_NEAR(r.L[0][0],
              (1 - T10) + T10 * 0.25 * ((1 - T60) + T60 * 8) + T10 * 0.75 * (1 - T20),
              1e-5);
  EXPECT_NEAR(r.T[0][1], std::exp(-.5), 1e-6);
  EXPECT_NEAR(r.T[0][2], std::exp(-3.), 1e-6);
}

}  // namespace
}  // namespace brume
