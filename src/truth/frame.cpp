#include "truth/frame.h"

#include <algorithm>
#include <cmath>

#include "num/error.h"
#include "truth/input.h"
#include "truth/surface.h"

namespace brume::truth {
namespace {

// T C: what nothing comes through is 0, however bright.
double under(double T, double C) { return T == 0 ? 0 : T * C; }

}  // namespace

bool Pixel::undecided(double tolerance, double white) const {
  for (int c = 0; c < 3; ++c)
    if (under(T[c], S_error[c]) > tolerance / 4 * (white + std::abs(C[c]))) return true;
  return false;
}

struct Frame::Impl {
  FrameInput in;
  Surfaces surfaces;
  std::vector<World> alone;  // the media of one stage each

  Impl(const Session& session, double frame, const std::filesystem::path& path)
      : in(session, frame, path), surfaces(in) {}

  const PreparedFrame::Impl& f() const { return in.f(); }

  double coverage(double alpha) const {
    if (f().plate) return 1;
    return std::isnan(alpha) ? 1 : std::clamp(alpha, 0., 1.);
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
  for (std::size_t k = 0; k < f.stages.size(); ++k) {
    World w = f.world;
    std::erase_if(w.media, [&](const auto& m) { return m.stage != int(k); });
    i.alone.push_back(std::move(w));
  }
}
Frame::~Frame() = default;
Frame::Frame(Frame&&) noexcept = default;

const PreparedFrame& Frame::prepared() const { return impl_->in.prepared; }
const ImageReader& Frame::source() const { return impl_->in.files.main(); }
Window Frame::window() const { return impl_->in.window; }
double Frame::distance(int x, int y) const { return impl_->in.distance(x, y); }
double Frame::coverage(int x, int y) const {
  return impl_->coverage(impl_->in.alpha(x, y));
}
double Frame::climb(int x, int y) const {
  return glm::dot(impl_->in.ray(x, y).direction, impl_->f().world.up);
}
std::vector<std::string> Frame::unproven() const { return impl_->surfaces.unproven(); }

std::vector<std::vector<float>> Frame::product() const {
  const FrameInput& in = impl_->in;
  std::vector<std::vector<float>> made(
      in.prepared.outputs().size(), std::vector<float>(std::size_t(in.window.pixels())));
  std::vector<PlaneOut> out;
  for (auto& p : made) out.push_back({p.data(), 1, in.window.width});
  std::vector<PlaneIn> from;
  for (const auto& p : in.in) from.push_back({p.data(), 1, in.window.width});
  FrameBuffers buffers;
  buffers.window = in.window;
  buffers.in = from;
  buffers.out = out;
  in.prepared.apply(buffers, in.window);
  return made;
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
  const Surface surface = i.surfaces.at(x, y);
  Pixel p;
  p.S = surface.S;
  p.S_error = surface.S_error;
  p.added = surface.added;
  p.distance = i.in.distance(x, y);
  const bool infinite = p.distance == kInf;
  p.coverage = i.coverage(surface.alpha);
  const double d = f.plate && infinite ? double(f.background_distance) : p.distance;

  const View::RayAt r = i.in.ray(x, y);
  std::vector<double> weights;
  for (const RunningStage& stage : f.stages)
    weights.push_back(i.in.weight(stage, x, y, infinite));
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
  // As much of the background as of the stage that brings it.
  double fills = 0;
  for (std::size_t k = 0; sees_background && k < f.stages.size(); ++k)
    if (f.stages[k].fills) fills = std::max(fills, weights[k]);
  Rgb B = fills > 0 ? background(f.world, r.origin, r.direction) : Rgb{};
  for (double& c : B) c *= fills;

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
    p.C_error[c] = p.L_error[c] + under(p.T_error[c], std::abs(p.S[c])) +
                   under(p.T[c], p.S_error[c]);
  }
  p.converged = near.converged && far.converged;
  p.alpha = fills == 1 ? 1 : a + (1 - a) * std::max(fills, 1 - mean_T);
  if (options.stages) i.add_shares(p, r, d, both, o);
  return p;
}

}  // namespace brume::truth
