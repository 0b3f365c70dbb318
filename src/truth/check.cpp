#include "truth/check.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "num/random.h"
#include "pipeline/impl.h"
#include "stage/registry.h"

namespace brume::truth {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

struct Place {
  int x, y, kind;
};

/// Pixels by what is special about them.
class Choice {
 public:
  Choice(const Frame& frame, std::span<const std::vector<float>> product, int count,
         std::uint64_t seed)
      : frame_(frame), product_(product), w_(frame.window()), random_(seed) {
    if (w_.pixels() <= count) {
      for (int y = w_.y; y < w_.bottom(); ++y)
        for (int x = w_.x; x < w_.right(); ++x) places.push_back({x, y, 0});
      return;
    }
    measure();
    const int each = std::max(1, count * 2 / 3 / int(kinds.size() - 1));
    take(
        "horizon", each, [&](std::size_t i) { return -std::abs(climb_[i]); }, .03);
    take(
        "grazing", each, [&](std::size_t i) { return graze(i); }, .03);
    take(
        "silhouettes", each, [&](std::size_t i) { return step(i); }, .03);
    take(
        "near", each,
        [&](std::size_t i) { return distance_[i] < kInf ? -distance_[i] : -kInf; }, .02);
    take(
        "far", each,
        [&](std::size_t i) { return distance_[i] < kInf ? distance_[i] : -kInf; }, .03);
    take(
        "bright", each, [&](std::size_t i) { return bright(i); }, .01);
    take(
        "sky", each, [&](std::size_t i) { return distance_[i] == kInf ? 1. : -kInf; }, 1);
    spread(std::max(1, count - int(places.size())));
  }

  std::vector<std::string> kinds{"evenly", "horizon", "grazing", "silhouettes",
                                 "near",   "far",     "bright",  "sky"};
  std::vector<Place> places;

 private:
  void measure() {
    const std::size_t n = std::size_t(w_.pixels());
    distance_.resize(n), climb_.resize(n), coverage_.resize(n);
    tbb::parallel_for(0, w_.height, [&](int row) {
      for (int x = 0; x < w_.width; ++x) {
        const std::size_t i = std::size_t(row) * std::size_t(w_.width) + std::size_t(x);
        distance_[i] = frame_.distance(w_.x + x, w_.y + row);
        coverage_[i] = frame_.coverage(w_.x + x, w_.y + row);
        climb_[i] = frame_.climb(w_.x + x, w_.y + row);
      }
    });
  }

  // How many times the distance changes to the pixel above, without a silhouette's step.
  double graze(std::size_t i) const {
    if (i < std::size_t(w_.width) || distance_[i] == kInf) return -kInf;
    const double ratio =
        std::abs(std::log(distance_[i - std::size_t(w_.width)] / distance_[i]));
    return ratio < .2 ? ratio : -kInf;
  }
  double step(std::size_t i) const {
    const double partial = coverage_[i] > 0 && coverage_[i] < 1 ? 1 : 0;
    const std::size_t left = i % std::size_t(w_.width) ? i - 1 : i;
    const double a = distance_[i], b = distance_[left];
    const double s = a == b ? 0 : a == kInf || b == kInf ? 10 : std::abs(std::log(a / b));
    return partial + s > .2 ? partial + s : -kInf;
  }
  double bright(std::size_t i) const {
    const auto& f = frame_.prepared().impl();
    double sum = 0;
    for (int c = 0; f.color_out.wanted() && c < 3; ++c)
      sum += double(product_[std::size_t(f.color_out.first + c)][i]);
    return std::isfinite(sum) ? sum : -kInf;
  }

  // `n` at random of the `part` of all pixels with the largest score.
  template <class F>
  void take(const std::string& kind, int n, const F& score, double part) {
    std::vector<std::pair<double, std::uint32_t>> all;
    for (std::size_t i = 0; i < distance_.size(); ++i)
      if (const double s = score(i); s > -kInf) all.push_back({-s, std::uint32_t(i)});
    const auto keep =
        std::min(all.size(),
                 std::max(std::size_t(n), std::size_t(part * double(distance_.size()))));
    std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(keep), all.end());
    all.resize(keep);
    std::sort(all.begin(), all.end());  // the same choice whatever nth_element left
    const int k = int(std::find(kinds.begin(), kinds.end(), kind) - kinds.begin());
    for (int i = 0; i < n && !all.empty(); ++i) {
      const auto at = std::size_t(random_.uniform() * double(all.size()));
      add(all[at].second, k);
      all[at] = all.back();
      all.pop_back();
    }
  }

  // One at random in each of n cells of equal size.
  void spread(int n) {
    const double aspect = double(w_.width) / w_.height;
    const int columns = std::max(1, int(std::lround(std::sqrt(n * aspect))));
    const int rows = std::max(1, (n + columns - 1) / columns);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const int x = int((c + random_.uniform()) * w_.width / columns);
        const int y = int((r + random_.uniform()) * w_.height / rows);
        places.push_back({w_.x + x, w_.y + y, 0});
      }
  }

  void add(std::uint32_t i, int kind) {
    places.push_back({w_.x + int(i % std::uint32_t(w_.width)),
                      w_.y + int(i / std::uint32_t(w_.width)), kind});
  }

  const Frame& frame_;
  std::span<const std::vector<float>> product_;
  Window w_;
  Random random_;
  std::vector<double> distance_, coverage_, climb_;
};

/// One pixel's errors.
struct Measured {
  double ratio = 0, dS = 0, dT = 0, dL = 0, dC = 0, truth = 0;
  bool converged = true, undecided = false;
};

}  // namespace

Check check_frame(const Session& given, double number, const std::filesystem::path& in,
                  int count, std::uint64_t seed) {
  SceneFile scene = given.scene();
  set(scene, "output.aovs=[\"T\", \"L\"]", {});
  for (StageEntry& stage : scene.stages)  // what mixes pixels after the air
    if (given.registry().find(stage.type, stage.where).role == BRUME_LENS)
      stage.enabled = false;
  const Session session(std::move(scene), given.registry());
  const Frame frame(session, number, in);
  const PreparedFrame::Impl& f = frame.prepared().impl();
  const auto output = SceneFile::section<OutputSection>(session.scene().output, number);
  Check check;
  const double tolerance = session.scene().tolerance;
  check.promised = std::max(tolerance, frame.prepared().plan().promised);
  check.white = output.white;
  if (!f.color_out.wanted()) return check;  // nothing changes

  const auto product = frame.product();
  const Choice choice(frame, product, count, seed);
  const Window w = frame.window();
  PixelOptions asked;
  asked.tolerance = 1e-2 * tolerance;
  asked.evaluations = 3'000'000;  // few pixels, each held to be right
  asked.ways = 100'000;
  asked.enough = 1e-1 * tolerance;
  asked.white = check.white;
  std::vector<Measured> measured(choice.places.size());
  tbb::parallel_for(std::size_t(0), measured.size(), [&](std::size_t k) {
    const Place& at = choice.places[k];
    const Pixel p = frame.pixel(at.x, at.y, asked);
    const std::size_t i =
        std::size_t(at.y - w.y) * std::size_t(w.width) + std::size_t(at.x - w.x);
    Measured& m = measured[k];
    m.converged = p.converged;
    m.undecided = p.undecided(check.promised, check.white);
    const auto off = [&](OutputRgb layer, const Rgb& truth, int c) {
      if (!layer.wanted()) return 0.;
      const double made = double(product[std::size_t(layer.first + c)][i]);
      return made == truth[c] || (std::isnan(made) && std::isnan(truth[c]))
                 ? 0
                 : std::abs(made - truth[c]);
    };
    for (int c = 0; c < 3; ++c) {
      const double dC = off(f.color_out, p.C, c);
      const double promised = check.promised * (check.white + std::abs(p.C[c]));
      m.dS = std::max(m.dS, off(f.S_out, p.S, c));
      m.dT = std::max(m.dT, off(f.T_out, p.T, c));
      m.dL = std::max(m.dL, off(f.L_out, p.L, c));
      m.dC = std::max(m.dC, dC);
      if (!m.undecided) m.truth = std::max(m.truth, p.C_error[c] / promised);
      // NaN on one side only is as wrong as can be.
      const double ratio = std::max(dC - p.C_error[c], 0.) / promised;
      m.ratio = std::max(m.ratio, std::isnan(dC)           ? kInf
                                  : dC == 0 || m.undecided ? 0
                                                           : ratio);
    }
  });

  for (std::size_t kind = 0; kind < choice.kinds.size(); ++kind) {
    CheckClass c;
    c.name = choice.kinds[kind];
    std::vector<double> ratios;
    for (std::size_t k = 0; k < measured.size(); ++k) {
      const Measured& m = measured[k];
      if (choice.places[k].kind != int(kind)) continue;
      ratios.push_back(m.ratio);
      if (ratios.size() > 1 && m.ratio <= c.worst) continue;
      c.worst = m.ratio;
      c.x = choice.places[k].x, c.y = choice.places[k].y;
      c.dS = m.dS, c.dT = m.dT, c.dL = m.dL, c.dC = m.dC;
    }
    if (ratios.empty()) continue;
    c.pixels = int(ratios.size());
    const auto rank = std::ptrdiff_t((ratios.size() * 99 + 99) / 100 - 1);
    std::nth_element(ratios.begin(), ratios.begin() + rank, ratios.end());
    c.p99 = ratios[std::size_t(rank)];
    check.worst = std::max(check.worst, c.worst);
    check.classes.push_back(c);
  }
  check.pixels = int(measured.size());
  check.unproven = frame.unproven();
  for (const Measured& m : measured) {
    check.truth_error = std::max(check.truth_error, m.truth);
    check.unconverged += !m.converged;
    check.undecided += m.undecided;
  }
  return check;
}

}  // namespace brume::truth
