#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stress/draw.h"
#include "stress/group.h"
#include "stress/pixels.h"

namespace brume::stress {
namespace {

constexpr double kEps = std::numeric_limits<float>::epsilon();

// What a lens may be off in a frame whose brightest pixel is `brightest`: a tenth of the
// tolerance is what it may leave out (other stages have the rest), 1e-5 of a pixel what
// its method may do to it, and rounding in double what all light may do to every pixel.
struct LensSlack {
  double tolerance, white;
  double operator()(double value, double brightest, double times) const {
    return times * (0.1 * tolerance * white + 1e-5 * std::abs(value) + 1e-13 * brightest);
  }
};

bool gives(float x) { return std::isfinite(x) && x > 0; }

struct LensGroup final : Group {
  using Group::Group;

  Options options;
  FrameInfo frame;
  PixelStage stage;
  Pixels in, out;
  Random random{0};
  bool spoilt = false;

  int size() const override { return in.size(); }
  LensSlack slack() const { return {options.tolerance, options.white}; }

  static double brightest(const Pixels& p, int c) {
    double most = 0;
    for (int i = 0; i < p.size(); ++i)
      if (const float x = p.rgb[c][p.at(i)]; gives(x)) most = std::max(most, double(x));
    return most;
  }

  template <class F>
  void each(F&& f) const {
    for (int i = 0; i < in.size(); ++i)
      for (int c = 0; c < 3; ++c) f(i, c, in.at(i));
  }

  Pixels run(Pixels p) const {
    run_on(stage, p);
    return p;
  }

  void check_values(Findings& found) const {
    double before[3] = {}, after[3] = {};
    bool light = true;  // what is negative is none
    each([&](int i, int c, std::size_t k) {
      const float x = in.rgb[c][k], y = out.rgb[c][k];
      if (std::isfinite(x))
        found.holds(Law::finite, case_of(i), c, y, x, std::isfinite(y));
      if (x >= 0 && std::isfinite(x))
        found.at_most(Law::positive, case_of(i), c, -double(y), 0, 4 * kEps * double(x));
      if (c == 0 && !stage.needs.changes_alpha)
        found.same(Law::alpha, case_of(i), c, out.alpha[k], in.alpha[k]);
      light = light && !(x < 0);
      if (!std::isfinite(x) || !std::isfinite(y)) return;
      before[c] += double(x), after[c] += double(y);
    });
    if (!(stage.needs.laws & BRUME_KEEPS_LIGHT) || !light) return;
    for (int c = 0; c < 3; ++c)
      found.at_most(Law::keeps, case_of(0), c, after[c], before[c],
                    1e-6 * size() * brightest(in, c));
  }

  // Elsewhere in memory; and black pixels where there are no numbers.
  void check_same(Findings& found) {
    const Pixels moved = run(in.moved(1 + integer(random, 15)));
    each([&](int i, int c, std::size_t k) {
      found.same(Law::lanes, case_of(i), c, moved.rgb[c][moved.at(i)], out.rgb[c][k]);
    });
    Pixels other = in;
    std::vector<char> changed(std::size_t(in.size()));
    const auto no_number = [](float x) { return !std::isfinite(x); };
    for (int i = 0; i < in.size(); ++i) {
      float* const rgb[3] = {&other.rgb[0][in.at(i)], &other.rgb[1][in.at(i)],
                             &other.rgb[2][in.at(i)]};
      for (float* x : rgb)
        if (no_number(*x)) *x = 0, changed[std::size_t(i)] = 1;
    }
    if (std::none_of(changed.begin(), changed.end(), std::identity{})) return;
    const Pixels black = run(other);
    each([&](int i, int c, std::size_t k) {
      if (!changed[std::size_t(i)])
        found.same(Law::neighbours, case_of(i), c, black.rgb[c][k], out.rgb[c][k]);
    });
  }

  void check_isas(Findings& found) const {
    for (const PixelStage::Lower& lower : stage.lower) {
      PixelStage there = stage;
      there.run = lower.run;
      Pixels p = in;
      run_on(there, p);
      each([&](int i, int c, std::size_t k) {
        if (!std::isfinite(in.rgb[c][k])) return;  // it stays as it is: `neighbours`
        const double want = double(out.rgb[c][k]);
        found.near(Law::isa, case_of(i), c, double(p.rgb[c][k]), want,
                   slack()(want, brightest(in, c), 2));
      });
    }
  }

  void check_dark(Findings& found) const {
    Pixels none = in;
    for (auto& plane : none.rgb) std::fill(plane.begin(), plane.end(), 0.f);
    const Pixels still = run(none);
    each([&](int i, int c, std::size_t k) {
      found.same(Law::dark, case_of(i), c, still.rgb[c][k], 0.f);
    });
  }

  // out(a I + b J) = a out(I) + b out(J); out(k I) = k out(I).
  void check_linear(Findings& found) {
    if (!(stage.needs.laws & BRUME_LINEAR) || spoilt) return;
    Pixels other = in, sum = in, more = in;
    draw_colors(random, other, false);
    const double a = log_uniform(random, 1e-3, 1e3), b = log_uniform(random, 1e-3, 1e3),
                 factor = log_uniform(random, 1e-6, 1e6);
    each([&](int, int c, std::size_t k) {
      sum.rgb[c][k] = float(a * double(in.rgb[c][k]) + b * double(other.rgb[c][k]));
      more.rgb[c][k] = float(factor * double(in.rgb[c][k]));
    });
    const Pixels of_other = run(other), of_sum = run(sum), of_more = run(more);
    each([&](int i, int c, std::size_t k) {
      const double want = a * double(out.rgb[c][k]) + b * double(of_other.rgb[c][k]);
      found.near(Law::linear, case_of(i), c, double(of_sum.rgb[c][k]), want,
                 slack()(want, brightest(sum, c), 1 + a + b));
      found.near(Law::exposure, case_of(i), c, double(of_more.rgb[c][k]),
                 factor * double(out.rgb[c][k]),
                 slack()(factor * double(out.rgb[c][k]), brightest(more, c), 1 + factor));
    });
  }

  void check_laws(Findings& found) override {
    check_values(found);
    check_same(found);
    check_isas(found);
    check_dark(found);
    check_linear(found);
  }

  Verdict check_truth(int i, Findings& found) override {
    if (!stage.truth) return Verdict::none;
    const std::array<double, 3> want = truth_of(stage, in, i);
    for (int c = 0; c < 3; ++c) {
      const double x = want[std::size_t(c)];
      if (!std::isfinite(x)) continue;  // it stays as it is: `neighbours`, `finite`
      found.near(Law::truth, case_of(i), c, double(out.rgb[c][in.at(i)]),
                 std::min(x, double(std::numeric_limits<float>::max())),
                 slack()(x, brightest(in, c), 1));
    }
    return Verdict::given;
  }

  std::string describe(int i) override {
    const std::size_t k = in.at(i);
    return fmt::format(
        "# {} x {} pixels of {} rad, pixel ({}, {}): {} {} {} alpha {}, out {} {} {}\n",
        in.width, in.height, frame.pixel_footprint, i % in.width, i / in.width,
        in.rgb[0][k], in.rgb[1][k], in.rgb[2][k], in.alpha[k], out.rgb[0][k],
        out.rgb[1][k], out.rgb[2][k]);
  }
};

}  // namespace

std::unique_ptr<Group> make_lens_group(const Setting& setting, const Options& options,
                                       std::uint64_t number, Random random) {
  auto g = std::make_unique<LensGroup>(number);
  g->options = options;
  g->random = random;
  g->frame = setting.frame;
  // A pattern serves all groups of a setting: they have one size.
  Random of_setting(~options.seed, setting.number);
  const auto [width, height] = draw_size(of_setting);
  g->frame.display = {0, 0, width, height};
  g->stage = setting.subject.at(g->frame);
  g->in.resize(width, height, 0, 0);
  g->spoilt = integer(g->random, 3) == 0;
  draw_colors(g->random, g->in, g->spoilt);
  for (std::size_t k = 0; k < g->stage.needs.channels.size(); ++k) {
    g->in.channels.emplace_back(g->in.alpha.size());
    for (float& x : g->in.channels.back()) x = float(g->random.uniform());
  }
  g->in.channels.resize(g->stage.needs.channels.size() + g->stage.needs.optional.size());
  g->out = g->run(g->in);
  return g;
}

}  // namespace brume::stress
