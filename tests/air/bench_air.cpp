// bench_air [lamps]: nanoseconds per ray of the integrator, by instruction set: one
// height fog (the fast path), then 2, 4 and 8 media that overlap, 2 to 16 that do not,
// against the sum of what each costs alone, many small ones, lamps, a sun. One thread;
// the least of 15 runs. Then the closed form of a lamp's glow against a march of 64 even
// steps over the stiff grid of the tests. `lamps`: these alone.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "air/airlight.h"
#include "airlight_oracle.h"
#include "support.h"

using namespace brume;
using namespace brume::testing_air;

namespace {

double nanoseconds(const Air& air, const Bundle& b, int repeats) {
  Result r;
  for (int c = 0; c < 3; ++c) {
    r.T[c].resize(std::size_t(b.size()));
    r.L[c].resize(std::size_t(b.size()));
  }
  const AirOut out{{r.T[0].data(), r.T[1].data(), r.T[2].data()},
                   {r.L[0].data(), r.L[1].data(), r.L[2].data()},
                   {},
                   {}};
  std::vector<double> times;
  for (int run = 0; run < 15; ++run) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < repeats; ++i) air.integrate(b.spans(), {}, out);
    const std::chrono::duration<double, std::nano> t =
        std::chrono::steady_clock::now() - start;
    times.push_back(t.count() / repeats / b.size());
  }
  return *std::min_element(times.begin(), times.end());
}

// Rays of a picture: 60 degrees wide, depths 10 m to 3 km.
Bundle picture(int width, int height) {
  Bundle b;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = (x + .5) / width - .5, v = (y + .5) / height - .5;
      b.add({1.15 * u, 1, -0.65 * v},
            10 + 3000 * std::abs(std::sin(7 * u) * std::cos(5 * v)));
    }
  return b;
}

Air compiled(const World& w, Isa isa) {
  AirOptions o = options();
  o.isa = isa;
  return Air::compile(w, o);
}

// k media behind each other, and over the sum of their costs, each alone in the world.
void behind_each_other(const std::string& what, const std::vector<brume_medium>& media,
                       const Bundle& b) {
  std::printf("%-34s", (what + ": " + std::to_string(media.size())).c_str());
  for (Isa isa : isas()) {
    double alone = 0, together = 1e30;
    std::vector<Air> airs;
    for (const auto& m : media) airs.push_back(compiled(world_of({m}), isa));
    for (const Air& air : airs) alone += nanoseconds(air, b, 5);
    const Air all = compiled(world_of(media), isa);
    together = nanoseconds(all, b, 5);
    std::printf(" %5.1f %.2fx", together, together / alone);
    std::fflush(stdout);
  }
  std::printf("\n");
}

// Slabs of fog across the view, one behind the other: boxes, layers of height fog cut by
// boxes, ellipsoids.
void apart(const Bundle& b) {
  for (int k : {2, 4, 8, 16})
    for (const char* what : {"boxes", "layers of height fog", "ellipsoids"}) {
      std::vector<brume_medium> media;
      for (int i = 0; i < k; ++i) {
        const double at = 100 + 1600. * (i + .5) / k, half = 700. / k;
        const double color = .2 + .6 * i / k;
        auto m = fog(2e-3, color);
        if (*what == 'l') m = height_fog(2e-3, 1e-2, 0, color);
        media.push_back(shaped(m, *what == 'e' ? BRUME_ELLIPSOID : BRUME_BOX, {0, at, 0},
                               {3 * at + 900, half, 3 * at + 900}));
      }
      behind_each_other(std::string("apart, ") + what, media, b);
    }
}

void line(const char* what, const World& w, const Bundle& b, int repeats) {
  std::printf("%-34s", what);
  for (Isa isa : isas()) {
    std::printf(" %9.2f", nanoseconds(compiled(w, isa), b, repeats));
    std::fflush(stdout);
  }
  std::printf("\n");
}

// The glow as a march of `steps` even steps has it: the integrand at their middles.
Batch marched(Batch s, Batch h, Batch foot, Batch length, int steps) {
  Batch sum(0.f);
  const Batch dt = length / Batch(float(steps));
  for (int k = 0; k < steps; ++k) {
    const Batch t = dt * Batch(float(k) + 0.5f), x = t - foot, r2 = h * h + x * x;
    sum += exp(-s * (t + sqrt(r2))) / r2;
  }
  return sum * dt;
}

template <class F>
double nanoseconds_per_value(F f) {
  [[maybe_unused]] volatile float sink = 0;
  double best = 1e9;
  for (int run = 0; run < 15; ++run) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 2000; ++i) sink = f(Batch(1e-3f) * iota<Batch>())[0];
    const std::chrono::duration<double, std::nano> t =
        std::chrono::steady_clock::now() - start;
    best = std::min(best, t.count() / 2000 / Batch::W);
  }
  return best;
}

double median(std::vector<double> v) {
  const auto middle = v.begin() + std::ptrdiff_t(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

// The same kernels, errors over the grid, time in fog of 0.01 around a lamp at 20 m.
void against_a_march() {
  std::vector<double> closed, march;
  for (const auto& c : oracle::stiff_airlight()) {
    const long double truth = oracle::airlight(c.s, c.s, c.h, c.foot, 0, c.length);
    if (truth < 1e-30L) continue;
    const Batch s(c.s), h(c.h), foot(c.foot), length(c.length);
    const float a = air::airlight(s, air::sight(h, -foot, length - foot, length))[0];
    const float b = marched(s, h, foot, length, 64)[0];
    closed.push_back(double(std::abs(a / truth - 1)));
    march.push_back(double(std::abs(b / truth - 1)));
  }
  const double one = nanoseconds_per_value([](Batch more) {
    const Batch h = Batch(1.f) + more, foot(20.f), end(100.f);
    return air::airlight(Batch(.01f), air::sight(h, -foot, end - foot, end));
  });
  const double other = nanoseconds_per_value(
      [](Batch more) { return marched(.01f, Batch(1.f) + more, 20.f, 100.f, 64); });
  std::printf(
      "closed form: median error %.2g, %.1f ns; 64 even steps: %.2g, %.1f ns; "
      "error over error %.3g\n",
      median(closed), one, median(march), other, median(march) / median(closed));
}

void media_lines() {
  const Bundle small = picture(64, 4), block = picture(64, 32),
               frame = picture(1920, 1080);
  const auto fog1 = height_fog(2e-3, 1e-2, 0, .8);
  auto coloured = fog1;
  coloured.extinction[2] *= 1.5;
  line("height fog, 256 rays in cache", world_of({fog1}), small, 2000);
  line("height fog, 1920 x 1080 planes", world_of({fog1}), frame, 1);
  line("height fog, coloured extinction", world_of({coloured}), small, 2000);
  line("box of fog, 256 rays",
       world_of({shaped(fog1, BRUME_BOX, {0, 500, 0}, {300, 300, 300})}), small, 2000);
  for (int k : {2, 4, 8}) {
    std::vector<brume_medium> media;
    for (int i = 0; i < k; ++i)
      media.push_back(height_fog(2e-3 / (i + 1), 1e-2 / (1 + i), 10 * i, .2 + .1 * i));
    line(("overlapping height fogs: " + std::to_string(k)).c_str(), world_of(media),
         block, 3);
  }
  apart(block);
  // A thousand small volumes all over the picture: what bounds and sorting save.
  Random random(1);
  std::vector<brume_medium> puffs;
  for (int i = 0; i < 1000; ++i)
    puffs.push_back(shaped(
        fog(.02, random.uniform(0, 1)), BRUME_ELLIPSOID,
        {random.uniform(-800, 800), random.uniform(100, 2000), random.uniform(-400, 400)},
        {20, 20, 20}));
  line("a thousand ellipsoids", world_of(puffs), block, 1);
}

void light_lines() {
  const Bundle block = picture(64, 32);
  auto glowing = height_fog(2e-3, 1e-2, 0, .8);
  for (int c = 0; c < 3; ++c) glowing.albedo[c] = .9, glowing.color[c] = 0;
  brume_light lamp = {};
  lamp.size = sizeof lamp;
  lamp.kind = BRUME_POINT;
  lamp.attenuated = 1;
  lamp.position[1] = 40;
  for (double& p : lamp.power) p = 1000;
  line("height fog, one point light", world_of({glowing}, {lamp}), block, 1);
  // What is asymmetric has no closed form: so little of it is the same work but for that.
  auto even = fog(2e-3), uneven = even;
  for (auto* m : {&even, &uneven})
    for (double& a : m->albedo) a = .9;
  uneven.g = 1e-9;
  line("uniform fog, point light, closed", world_of({even}, {lamp}), block, 20);
  line("uniform fog, point light, by angle", world_of({uneven}, {lamp}), block, 1);
  even.extinction[2] = 3e-3;
  line("coloured fog, point light, closed", world_of({even}, {lamp}), block, 20);
  lamp.kind = BRUME_SPOT;
  lamp.direction[0] = .6, lamp.direction[1] = -.8;  // toward the eye's side
  lamp.cone = .6, lamp.cone_soft = .2;
  line("uniform fog, spotlight", world_of({uneven}, {lamp}), block, 1);
  lamp.kind = BRUME_SUN;
  lamp.direction[2] = 1;
  for (double& p : lamp.power) p = 5;
  line("height fog, sun dimmed by it", world_of({glowing}, {lamp}), block, 1);
}

}  // namespace

int main(int count, char** words) {
  std::printf("%-34s", "ns per ray");
  for (Isa isa : isas()) std::printf(" %9s", name(isa));
  std::printf("\n");
  if (count < 2 || std::string(words[1]) != "lamps") media_lines();
  light_lines();
  against_a_march();
}
