// From wavelengths to colours.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "color.h"
#include "models_test.h"
#include "nishita.h"

namespace {

using namespace brume;
using namespace brume::sky;

constexpr std::array<double, 8> kRec709 = {.64, .33, .3, .6, .15, .06, .3127, .329};

TEST(Color, MatchingFunctionsAreThoseOfTheCie) {
  // CIE 1931, 2 degrees (CIE 15:2004, table T.4); the fit's own claim is 3 % of the
  // maximum.
  const double table[][4] = {{450, .3362, .0380, 1.7721},
                             {500, .0049, .3230, .2720},
                             {550, .4334, .9950, .0087},
                             {600, 1.0622, .6310, .0008},
                             {650, .2835, .1070, 0}};
  for (const auto& row : table) {
    const auto xyz = matching(row[0]);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(xyz[c], row[1 + c], .03 * (c == 2 ? 1.78 : 1.06)) << row[0] << " " << c;
  }
}

TEST(Color, WhiteIsWhiteAndPrimariesArePrimary) {
  const auto M = rgb_from_xyz(kRec709);
  for (int i = 0; i < 4; ++i) {
    const double x = kRec709[2 * i], y = kRec709[2 * i + 1],
                 xyz[3] = {x / y, 1, (1 - x - y) / y};
    double rgb[3];
    for (int c = 0; c < 3; ++c)
      rgb[c] = M[c][0] * xyz[0] + M[c][1] * xyz[1] + M[c][2] * xyz[2];
    for (int c = 0; c < 3; ++c)
      if (c != i) {
        EXPECT_NEAR(rgb[c], i == 3, 1e-12);
      }
  }
}

TEST(Color, EightWavelengthsAreEnough) {
  // Single scattering carries the sky's whole spectral shape, and costs nothing at 40
  // wavelengths.
  const auto color = [](const std::vector<double>& nm, double view, double sun,
                        std::array<double, 3>& rgb) {
    const Model m(preset("earth", nm), nishita());
    const Colors colors = colors_of(nm, kRec709, sun_spectrum);
    std::vector<double> L(nm.size()), T(nm.size());
    m.see(ray_at(1, view, sun, 40), L.data(), T.data());
    rgb = {};
    for (std::size_t i = 0; i < nm.size(); ++i)
      for (int c = 0; c < 3; ++c) rgb[c] += colors.radiance[i][c] * L[i];
  };
  std::vector<double> many;
  for (int nm = 385; nm < 780; nm += 10) many.push_back(nm);
  const std::vector<std::vector<double>> lists = {
      {440, 550, 680},
      {385, 450, 515, 555, 590, 605, 640, 700},
      {390, 410, 430, 450, 470, 490, 510, 530, 550, 570, 590, 610, 630, 650, 680, 710}};
  for (std::size_t k = 0; k < lists.size(); ++k) {
    double worst = 0;
    for (double view : {0., 60., 88.})
      for (double sun : {20., 75., 88., 92.}) {
        std::array<double, 3> truth, rgb;
        color(many, view, sun, truth);
        color(lists[k], view, sun, rgb);
        const double most = std::max({truth[0], truth[1], truth[2]});
        for (int c = 0; c < 3; ++c)
          worst = std::max(worst, std::abs(rgb[c] - truth[c]) / most);
      }
    std::printf("%zu wavelengths: colour error %.2f %% of the brightest channel\n",
                lists[k].size(), 100 * worst);
    if (k > 0) {
      // Eight are placed, sixteen are spread.
      EXPECT_LE(worst, k == 1 ? .004 : .006) << lists[k].size();
    }
  }
}

}  // namespace
