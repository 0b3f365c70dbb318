#include "stress/pixels.h"

#include <algorithm>
#include <limits>

#include "stress/draw.h"

namespace brume::stress {

std::pair<int, int> draw_size(Random& r) {
  constexpr std::pair<int, int> kSizes[] = {
      {1, 1},  {2, 1},  {1, 3},  {128, 1}, {1, 128}, {127, 1}, {11, 11},
      {16, 8}, {8, 16}, {7, 17}, {13, 9},  {32, 4},  {3, 41},  {64, 2}};
  // Small ones seldom: they hold few cases.
  const int k = integer(r, 32);
  return k < 3 ? kSizes[k] : kSizes[3 + integer(r, int(std::size(kSizes)) - 3)];
}

float draw_bad(Random& r) {
  constexpr float kBad[] = {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity(),
                            -1.f,
                            0.f,
                            1e-42f,
                            3e38f,
                            -1e-20f};
  return kBad[integer(r, int(std::size(kBad)))];
}

void draw_colors(Random& r, Pixels& p, bool spoilt) {
  const double exposure = integer(r, 2) ? 1 : log_uniform(r, 1e-6, 1e6);
  const double sparks = integer(r, 3) ? 0 : r.uniform(0, 0.2),
               brightest = log_uniform(r, 1, 1e9);
  const bool covered = integer(r, 2);
  for (int i = 0; i < p.size(); ++i) {
    const double spark = r.uniform() < sparks ? brightest * r.uniform() : 1;
    for (auto& plane : p.rgb) plane[p.at(i)] = float(exposure * spark * r.uniform());
    p.alpha[p.at(i)] = covered              ? 1
                       : integer(r, 4) == 0 ? float(integer(r, 2))
                                            : float(r.uniform());
    if (!spoilt || integer(r, 6)) continue;
    const int what = integer(r, 4);
    (what < 3 ? p.rgb[what] : p.alpha)[p.at(i)] = draw_bad(r);
  }
}

void run_on(const PixelStage& stage, Pixels& p, const Window& part,
            const brume_world* world) {
  stage.run(p.tile(part, world));
}

void run_on(const PixelStage& stage, Pixels& p, const brume_world* world) {
  run_on(stage, p, {0, 0, p.width, p.height}, world);
}

std::array<double, 3> truth_of(const PixelStage& stage, Pixels& p, int i,
                               const brume_world* world) {
  std::array<double, 3> rgb{};
  const int xy[2] = {i % p.width, i / p.width};
  stage.truth(p.tile(world), xy, rgb.data());
  return rgb;
}

}  // namespace brume::stress
