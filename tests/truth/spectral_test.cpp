// Media of wavelengths: closed forms of even ones, alone and in fog of three colours.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support.h"

namespace brume {
namespace {

using namespace testing_truth;
using truth::along;
using truth::Answer;

/// Extinction 0.001 (i + 1) per metre and source 1 + i at wavelength i of `n`; colour c
/// sees wavelength i of light by 0.1 (1 + (i + c) % 3), of transmittance by equal parts.
struct Even {
  int n;
  std::vector<double> radiance, transmittance;

  explicit Even(int count) : n(count) {
    for (int i = 0; i < n; ++i)
      for (int c = 0; c < 3; ++c) {
        radiance.push_back(0.1 * (1 + (i + c) % 3));
        transmittance.push_back(1. / n);
      }
  }
  double sigma(int i) const { return 0.001 * (i + 1); }
  double source(int i) const { return 1. + i; }

  brume_medium medium() const {
    brume_medium m = fog(1);
    m.profile = BRUME_CUSTOM;
    m.source = BRUME_SOURCE_CUSTOM;
    m.self = this;
    m.point = [](const void*, const double*, const double*, double*, double*) {
      ADD_FAILURE() << "asked for three colours";
    };
    m.wavelengths = n;
    m.spectral_radiance = radiance.data();
    m.spectral_transmittance = transmittance.data();
    m.spectral_point = [](const void* self, const double*, const double*,
                          double* extinction, double* S) {
      const Even& e = *static_cast<const Even*>(self);
      for (int i = 0; i < e.n; ++i) extinction[i] = e.sigma(i), S[i] = e.source(i);
    };
    return m;
  }
};

// In even fog of extinction s_c and source S: sigma = sigma_i + s_c,
// L = Sum_i (R_ic sigma_i S_i + T_ic s_c S) (1 - e^{-sigma t}) / sigma.
void expect_closed_form(int n, double s, double S, double t) {
  const Even even(n);
  World w = world({even.medium()});
  if (s > 0) w.media.push_back({fog(s, S), 1, ""});
  const Answer a = along(w, {0, 0, 0}, {0, 1, 0}, t);
  EXPECT_TRUE(a.converged);
  for (std::size_t c = 0; c < 3; ++c) {
    double T = 0, L = 0;
    for (int i = 0; i < n; ++i) {
      const std::size_t k = 3 * std::size_t(i) + c;
      const double sigma = even.sigma(i) + s;
      T += even.transmittance[k] * std::exp(-sigma * t);
      L += (even.radiance[k] * even.sigma(i) * even.source(i) +
            even.transmittance[k] * s * S) *
           -std::expm1(-sigma * t) / sigma;
    }
    EXPECT_NEAR(a.T[c], T, 1e-9) << n << " " << s << " " << t;
    EXPECT_NEAR(a.L[c], L, 1e-9 * (1 + L)) << n << " " << s << " " << t;
  }
}

TEST(TruthSpectral, AColourIsASumOverWavelengths) {
  for (const int n : {1, 3, 8, 11, 30})
    for (const double t : {0., 1., 300., 1e5}) expect_closed_form(n, 0, 0, t);
}

TEST(TruthSpectral, FogOfThreeColoursIsSeenThroughEveryWavelength) {
  for (const int n : {3, 8, 11})
    for (const double s : {1e-4, 0.02, 50.}) expect_closed_form(n, s, 0.7, 400);
}

TEST(TruthSpectral, TransmittanceIsNoExponentialOfAMean) {
  // Half of the light at 0.001 per metre, half at 0.002, over 1 km: the mean of the
  // exponentials is above the exponential of the mean (Jensen).
  const Even even(2);
  const Answer a = along(world({even.medium()}), {0, 0, 0}, {0, 1, 0}, 1000);
  EXPECT_NEAR(a.T[0], (std::exp(-1.) + std::exp(-2.)) / 2, 1e-9);
  EXPECT_GT(a.T[0], std::exp(-1.5) + 0.02);
}

TEST(TruthSpectral, WeightsAndSharesScaleIt) {
  const Even even(8);
  World w = world({even.medium()});
  w.media.push_back({fog(0.01, 0.5), 1, ""});
  const std::vector<double> weights{0.25, 1};
  truth::Options o;
  o.weights = weights;
  const Answer both = along(w, {0, 0, 0}, {0, 1, 0}, 200, o);
  truth::Rgb sum{};
  for (const int k : {0, 1}) {
    o.only_stage = k;
    const Answer one = along(w, {0, 0, 0}, {0, 1, 0}, 200, o);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += one.L[c];
  }
  double T = 0;
  for (int i = 0; i < 8; ++i) T += std::exp(-(0.25 * even.sigma(i) + 0.01) * 200) / 8;
  EXPECT_NEAR(both.T[1], T, 1e-9);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], both.L[c], 1e-8);
}

}  // namespace
}  // namespace brume
