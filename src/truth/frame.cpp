#include "truth/frame.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "num/error.h"
#include "pipeline/impl.h"
#include "pipeline/sources.h"
#include "stage/registry.h"

namespace brume::truth {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr int kReach = 8;  // of DESIGN's nearest covered neighbour [pixels]

// T C: what nothing comes through is 0, however bright.
double under(double T, double C) { return T == 0 ? 0 : T * C; }

}  // namespace

struct Frame::Impl {
  FrameFiles files;
  PreparedFrame prepared;
  Window window;
  std::vector<std::vector<float>> in;  // by input
  std::vector<std::vector<float>> S;   // after surface stages, where there are any
  std::vector<float> covered;          // likewise, where they change the coverage
  std::vector<World> alone;            // the media of one stage each

  Impl(const Session& session, double frame, const std::filesystem::path& path)
      : files(session.scene(), frame, path),
        prepared(session.prepare(files.source({}))),
        window(files.main().header().data_window) {}

  const PreparedFrame::Impl& f() const { return prepared.impl(); }
  std::size_t at(int x, int y) const {
    return std::size_t(y - window.y) * std::size_t(window.width) +
           std::size_t(x - window.x);
  }
  double value(int input, int x, int y) const {
    return double(in[std::size_t(input)][at(x, y)]);
  }

  View::RayAt ray(int x, int y) const {
    if (f().view) return f().view->ray(x + .5, y + .5);
    return {f().world.eye, {0, 1, 0}, 1};
  }

  // DESIGN and SOURCES: what the depth channel means, +inf for background.
  double sample_distance(int x, int y) const {
    const PreparedFrame::Impl& p = f();
    const View::RayAt r = ray(x, y);
    if (p.position[0] >= 0) {
      if (p.alpha >= 0 && !(value(p.alpha, x, y) > 0)) return kInf;
      glm::dvec3 P;
      for (int c = 0; c < 3; ++c) P[c] = value(p.position[c], x, y);
      const bool finite = std::isfinite(P.x) && std::isfinite(P.y) && std::isfinite(P.z);
      if (!finite || P == glm::dvec3(0)) return kInf;
      return std::max(glm::dot(P * p.metres - r.origin, r.direction), 0.);
    }
    if (p.depth < 0) return kInf;
    const DepthRule& rule = p.depth_rule;
    const double z = value(p.depth, x, y);
    const double per_planar = 1 / r.planar_per_distance;
    switch (rule.kind) {
      case DepthKind::planar:
        return z > 0 && z < rule.background_from ? z * rule.metres * per_planar : kInf;
      case DepthKind::distance:
        return z > 0 && z < rule.background_from ? z * rule.metres : kInf;
      case DepthKind::inverse:
        return z > 0 && z < kInf ? rule.metres * per_planar / z : kInf;
      case DepthKind::normalised: {
        const double t = std::max(rule.white_near ? 1 - z : z, 0.);
        return std::isfinite(z) && t < 1
                   ? (rule.near + t * (rule.far - rule.near)) * per_planar
                   : kInf;
      }
    }
    return kInf;
  }

  // Partly covered without a depth: the nearest neighbour's, of equally near ones the
  // nearer to the eye.
  double distance(int x, int y) const {
    const double own = sample_distance(x, y);
    if (own < kInf || f().plate || f().alpha < 0 || !(value(f().alpha, x, y) > 0))
      return own;
    double best = kInf;
    int square = kReach * kReach + 1;
    for (int dy = -kReach; dy <= kReach; ++dy)
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const int s = dx * dx + dy * dy;
        const int nx = x + dx, ny = y + dy;
        if (s > square || s > kReach * kReach || nx < window.x || ny < window.y ||
            nx >= window.right() || ny >= window.bottom())
          continue;
        const double d = sample_distance(nx, ny);
        if (d == kInf || (s == square && d >= best)) continue;
        best = d;
        square = s;
      }
    return best;
  }

  double coverage(int x, int y, double distance) const {
    if (f().plate) return 1;
    if (f().alpha < 0) return distance < kInf ? 1 : 0;
    const double v = covered.empty() ? value(f().alpha, x, y) : double(covered[at(x, y)]);
    return std::isnan(v) ? 1 : std::clamp(v, 0., 1.);
  }

  std::vector<double> weights(int x, int y, bool behind) const {
    std::vector<double> w;
    for (const RunningStage& stage : f().stages) {
      double one = double(stage.mix);
      if (stage.mask >= 0) {
        const double m = value(stage.mask, x, y);
        one *= std::isnan(m) ? 0 : std::clamp(m, 0., 1.);
      }
      if (behind && f().plate && stage.is_sky) one = 0;
      w.push_back(one);
    }
    return w;
  }

  // Colour and coverage after surface stages, from their own code: the product's layer
  // S, and its coverage in a scene whose air is left out.
  void run_surfaces(const Session& session) {
    if (f().surface_end == 0) return;
    const std::span<const RunningStage> stages(f().stages);
    const auto surfaces = stages.first(std::size_t(f().surface_end));
    S = planes_of(session, "output.aovs=[\"S\"]", [](const PreparedFrame::Impl& with) {
      const int first = with.S_out.first;
      return std::vector{first, first + 1, first + 2};
    });
    if (f().alpha < 0 || std::ranges::none_of(surfaces, [](const RunningStage& s) {
          return s.needs.changes_alpha;
        }))
      return;
    SceneFile airless = session.scene();
    for (StageEntry& stage : airless.stages)
      if (session.registry().find(stage.type, stage.where).role == BRUME_AIR)
        stage.enabled = false;
    covered = planes_of(
        Session(std::move(airless), session.registry()), "output.alpha=\"over\"",
        [](const PreparedFrame::Impl& with) { return std::vector{with.alpha_out}; })[0];
  }

  // Some outputs of the product, with one thing set otherwise.
  template <class Which>
  std::vector<std::vector<float>> planes_of(const Session& session, const char* setting,
                                            const Which& which) const {
    SceneFile scene = session.scene();
    set(scene, setting, {});
    const Session other(std::move(scene), session.registry());
    const PreparedFrame with = other.prepare(files.source({}));
    auto all = planes(with);
    std::vector<std::vector<float>> wanted;
    for (const int k : which(with.impl()))
      wanted.push_back(std::move(all[std::size_t(k)]));
    return wanted;
  }

  // All outputs of the product.
  std::vector<std::vector<float>> planes(const PreparedFrame& with) const {
    std::vector<std::vector<float>> made(
        with.outputs().size(), std::vector<float>(std::size_t(window.pixels())));
    std::vector<PlaneOut> out;
    for (auto& p : made) out.push_back({p.data(), 1, window.width});
    std::vector<PlaneIn> from;
    for (const InputChannel& wanted : with.inputs()) {
      const auto same = [&](const InputChannel& own) {
        return own.file == wanted.file && own.channel == wanted.channel;
      };
      const auto found = std::ranges::find_if(f().inputs, same) - f().inputs.begin();
      from.push_back({in.at(std::size_t(found)).data(), 1, window.width});
    }
    FrameBuffers buffers;
    buffers.window = window;
    buffers.in = from;
    buffers.out = out;
    with.apply(buffers, window);
    return made;
  }

  void add_shares(Pixel& p, const View::RayAt& r, double d, bool both, Options o) const;
};

Frame::Frame(const Session& session, double frame, const std::filesystem::path& in)
    : impl_(std::make_unique<Impl>(session, frame, in)) {
  Impl& i = *impl_;
  const PreparedFrame::Impl& f = i.f();
  if (f.has_lens())
    throw Error(f.plan.stages[std::size_t(f.stages[std::size_t(f.air_end)].plan)].name,
                "the truth is about the air; a lens stage mixes pixels after it",
                "--set NAME.enabled=false leaves it out");
  for (std::size_t k = 0; k < f.inputs.size(); ++k)
    i.in.push_back(i.files.read_all(f.inputs[k], i.window, int(k) == f.depth));
  i.run_surfaces(session);
  for (std::size_t k = 0; k < f.stages.size(); ++k) {
    World w = f.world;
    std::erase_if(w.media, [&](const auto& m) { return m.stage != int(k); });
    i.alone.push_back(std::move(w));
  }
}
Frame::~Frame() = default;
Frame::Frame(Frame&&) noexcept = default;

const PreparedFrame& Frame::prepared() const { return impl_->prepared; }
const ImageReader& Frame::source() const { return impl_->files.main(); }
Window Frame::window() const { return impl_->window; }
double Frame::distance(int x, int y) const { return impl_->distance(x, y); }
double Frame::coverage(int x, int y) const {
  return impl_->coverage(x, y, impl_->distance(x, y));
}
double Frame::climb(int x, int y) const {
  return glm::dot(impl_->ray(x, y).direction, impl_->f().world.up);
}

std::vector<std::vector<float>> Frame::product() const {
  return impl_->planes(impl_->prepared);
}

void Frame::Impl::add_shares(Pixel& p, const View::RayAt& r, double d, bool both,
                             Options o) const {
  const double a = p.coverage;
  for (std::size_t k = 0; k < f().stages.size(); ++k) {
    o.only_stage = -1;
    p.stage_T.push_back(along(alone[k], r.origin, r.direction, d, o).T);
    o.only_stage = int(k);
    Rgb L = along(f().world, r.origin, r.direction, d, o).L;
    if (both) {
      const Rgb beyond = along(f().world, r.origin, r.direction, kInf, o).L;
      for (int c = 0; c < 3; ++c) L[c] = a * L[c] + (1 - a) * beyond[c];
    }
    p.stage_L.push_back(L);
  }
}

Pixel Frame::pixel(int x, int y, const PixelOptions& options) const {
  const Impl& i = *impl_;
  const PreparedFrame::Impl& f = i.f();
  Pixel p;
  for (int c = 0; c < 3; ++c)
    p.S[c] = i.S.empty() ? (f.color[c] < 0 ? 0 : i.value(f.color[c], x, y))
                         : double(i.S[std::size_t(c)][i.at(x, y)]);
  p.distance = i.distance(x, y);
  const bool infinite = p.distance == kInf;
  p.coverage = i.coverage(x, y, p.distance);
  const double d = f.plate && infinite ? double(f.background_distance) : p.distance;

  const View::RayAt r = i.ray(x, y);
  const std::vector<double> weights = i.weights(x, y, infinite);
  Options o;
  o.tolerance = options.tolerance;
  o.white = options.white;
  o.evaluations = options.evaluations;
  o.enough = options.enough;
  o.ways = options.ways;
  o.weights = weights;
  const Answer near = along(f.world, r.origin, r.direction, d, o);
  const double a = p.coverage;
  const bool both = a < 1 && d < kInf;
  const Answer far = both ? along(f.world, r.origin, r.direction, kInf, o) : near;
  const bool sees_background = !f.plate && f.own_background;
  const Rgb B = sees_background ? background(f.world, r.origin, r.direction) : Rgb{};

  double mean_T = 0;
  for (int c = 0; c < 3; ++c) {
    const double beyond = far.L[c] + under(far.T[c], B[c]);
    p.T[c] = near.T[c];
    p.L[c] = a == 1 ? near.L[c] : a == 0 ? beyond : a * near.L[c] + (1 - a) * beyond;
    p.C[c] = under(p.T[c], p.S[c]) + p.L[c];
    mean_T += far.T[c] / 3;
    p.T_error[c] = near.T_error[c];
    p.L_error[c] =
        a * near.L_error[c] + (1 - a) * (far.L_error[c] + far.T_error[c] * B[c]);
    p.C_error[c] = p.L_error[c] + under(p.T_error[c], std::abs(p.S[c]));
  }
  p.converged = near.converged && far.converged;
  p.alpha = sees_background ? 1 : a + (1 - a) * (1 - mean_T);
  if (options.stages) i.add_shares(p, r, d, both, o);
  return p;
}

}  // namespace brume::truth
