// What bounded media cost where they are not: scenes over 1920 x 1080 pixels in memory,
// one thread, the least of several runs, those of a box in turns and in place. A line
// each: what, seconds to prepare, ns per pixel.
//
//   bench_media             BRUME_ISA chooses the instruction set

#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <deque>
#include <exception>
#include <string>
#include <vector>

#include "memory_frame.h"
#include "num/random.h"

namespace {

using namespace brume;
using namespace brume::bench;

constexpr int kWidth = 1920, kHeight = 1080;

/// Looking north; stages as given.
std::string scene(const std::string& stages) {
  return "version = 1\n[camera]\nposition = [0, 0, 0]\nlook_at = [0, 1000, 0]\nfocal = "
         "36\naperture_width = 36\n" +
         stages;
}

std::string volume(const std::string& name, const char* shape, const double center[3],
                   const double half[3]) {
  char text[400];
  std::snprintf(text, sizeof text,
                "[[stage]]\ntype = \"fog_volume\"\nname = \"%s\"\nshape = \"%s\"\n"
                "center = [%.9g, %.9g, %.9g]\nhalf = [%.9g, %.9g, %.9g]\ndensity = "
                "0.01\n",
                name.c_str(), shape, center[0], center[1], center[2], half[0], half[1],
                half[2]);
  return text;
}
// A box whose face 100 m away fills a part of the picture's width and height.
std::string box(double part, double beside = 0) {
  const double center[] = {beside, 150, 0}, half[] = {50 * part, 50, 50 * part * 9 / 16};
  return volume("box", "box", center, half);
}

struct Case {
  std::string what, scene;
};

// In turns: what a busy machine takes from one it takes from all.
void measure(Registry& registry, MemoryFrame& f, const std::vector<Case>& cases,
             bool in_place, int rounds) {
  std::deque<OnFrame> scenes;
  for (const Case& c : cases) scenes.emplace_back(registry, c.scene, f, in_place);
  std::vector<double> prepare(cases.size(), 1e30), apply(cases.size(), 1e30);
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < cases.size(); ++i) {
      if (round < 3)
        prepare[i] = std::min(prepare[i], seconds([&] { scenes[i].prepare(); }));
      apply[i] = std::min(apply[i], seconds([&] { scenes[i].apply(); }));
    }
  for (std::size_t i = 0; i < cases.size(); ++i)
    std::printf("%s: %.4f s, %.4f ns\n", cases[i].what.c_str(), prepare[i],
                apply[i] * 1e9 / kWidth / kHeight);
  std::fflush(stdout);
}

// Boxes and ellipsoids of 1 to 8 m, 20 m to 1.5 km away, all over the picture.
std::string many(int count) {
  Random random{5};
  std::string all;
  for (int i = 0; i < count; ++i) {
    const double away = random.uniform(20, 1500), size = random.uniform(1, 8);
    const double center[] = {random.uniform(-.5, .5) * away, away,
                             random.uniform(-.3, .3) * away},
                 half[] = {size, size, size * random.uniform(.3, 1)};
    all += volume("v" + std::to_string(i), i % 2 ? "box" : "ellipsoid", center, half);
  }
  return all;
}

std::string bolt(const char* core, const char* glow) {
  return std::string(
             "[[stage]]\ntype = \"lightning\"\nform = \"bolt\"\npoints = [-30, 300, "
             "120, 20, 280, -60]\nbranches = 6\nseed = 11\ncore_radius = "
             "0.08\ncore_radiance = ") +
         core + "\nintensity = " + glow + "\n";
}

}  // namespace

int main() try {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  Registry registry;
  MemoryFrame f(kWidth, kHeight);
  measure(registry, f,
          {{"box beside the picture", scene(box(.1, 1000))},
           {"box on a hundredth", scene(box(.1))},
           {"box on all pixels", scene(box(1.2))}},
          true, 60);
  measure(registry, f,
          {{"nothing", scene(box(.1, 1000))},
           {"bolt, its core alone", scene(bolt("50", "0"))},
           {"bolt, its glow alone", scene(bolt("0", "0.1"))},
           {"bolt, core and glow", scene(bolt("50", "0.1"))},
           {"5000 boxes and ellipsoids", scene(many(5000))}},
          false, 15);
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "bench_media: %s\n", e.what());
  return 1;
}
