#include "study/reference.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>

namespace brume::study {

namespace {

// Far below the smallest tolerance that is studied.
constexpr double kTruth = 1e-7;

const std::string& name_of(const PreparedFrame::Impl& f, int k) {
  return f.plan.stages[std::size_t(f.stages[std::size_t(k)].plan)].name;
}

AirOptions options_of(const Prepared& p, double white) {
  AirOptions o;
  o.tolerance = p.tolerance;
  o.white = white;
  o.stages = int(p.impl().stages.size());
  return o;
}

std::shared_ptr<const Air> compiled(const World& w, const AirOptions& o) {
  return std::make_shared<const Air>(Air::compile(w, o));
}

// Some rays, spread evenly.
Rays few_of(const Rays& rays) {
  constexpr std::size_t kFew = 32;
  std::vector<std::uint32_t> few;
  const std::size_t n = std::min(kFew, rays.count);
  for (std::size_t k = 0; k < n; ++k)
    few.push_back(std::uint32_t((2 * k + 1) * rays.count / (2 * n)));
  return rays.pick(few);
}

}  // namespace

World world_of(const Prepared& p, const std::string& stage) {
  World w = p.impl().world;
  if (!stage.empty())
    std::erase_if(w.media,
                  [&](const auto& m) { return name_of(p.impl(), m.stage) != stage; });
  return w;
}

std::shared_ptr<const Air> air_of(const Prepared& p, const std::string& stage,
                                  double white) {
  return compiled(world_of(p, stage), options_of(p, white));
}

bool Judge::has_alone(const World& w) {
  return std::any_of(w.media.begin(), w.media.end(),
                     [](const auto& m) { return m.what.alone != nullptr; });
}

Judge::Judge(const Prepared& finest, const Prepared* by_ray, const std::string& stage,
             double white)
    : world_(world_of(finest, stage)), white_(white) {
  if (!has_alone(world_) || !by_ray) return;
  by_ray_ = air_of(*by_ray, stage, white);
  const auto& theirs = by_ray->impl().stages;
  for (int k = 0; k < int(theirs.size()); ++k) {
    stages_.push_back(-1);
    for (int j = 0; j < int(finest.impl().stages.size()); ++j)
      if (name_of(by_ray->impl(), k) == name_of(finest.impl(), j)) stages_.back() = j;
  }
}

Reference Judge::judge(const Rays& rays) const {
  if (!by_ray_) return truth_of(rays);
  Rays theirs = rays;
  theirs.weights.clear();
  for (const int k : stages_)
    theirs.weights.push_back(k < 0 ? std::vector<float>() : rays.weights[std::size_t(k)]);
  const Answers a = evaluate(ours(by_ray_), theirs);
  Reference r;
  for (std::size_t i = 0; i < rays.count; ++i) {
    r.T.push_back({double(a.T[0][i]), double(a.T[1][i]), double(a.T[2][i])});
    r.L.push_back({double(a.L[0][i]), double(a.L[1][i]), double(a.L[2][i])});
  }
  return r;
}

Reference Judge::truth_of(const Rays& rays) const {
  Reference r;
  r.T.resize(rays.count);
  r.L.resize(rays.count);
  std::mutex mutex;
  tbb::parallel_for(std::size_t(0), rays.count, [&](std::size_t i) {
    std::vector<double> weights;
    for (const auto& w : rays.weights) weights.push_back(w.empty() ? 1.0 : double(w[i]));
    glm::dvec3 origin = world_.eye;
    if (!rays.o[0].empty())
      origin += glm::dvec3(rays.o[0][i], rays.o[1][i], rays.o[2][i]);
    truth::Options o;
    o.tolerance = kTruth;
    o.white = white_;
    o.weights = weights;
    const truth::Answer a = along(
        world_, origin, {rays.d[0][i], rays.d[1][i], rays.d[2][i]}, double(rays.t[i]), o);
    double error = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      r.T[i][c] = a.T[c];
      r.L[i][c] = a.L[c];
      const double S = std::isfinite(rays.S[c][i]) ? double(rays.S[c][i]) : 0;
      error = std::max(error, (std::abs(S) * a.T_error[c] + a.L_error[c]) /
                                  (white_ + std::abs(S * a.T[c] + a.L[c])));
    }
    const std::lock_guard lock(mutex);
    r.error = std::max(r.error, error);
    r.unconverged += !a.converged;
  });
  return r;
}

double Judge::model_gap(const Rays& rays) const {
  if (!by_ray_) return 0;
  const Rays some = few_of(rays);
  Answers a(some);
  const Reference own = judge(some);
  for (std::size_t i = 0; i < some.count; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      a.T[c][i] = float(own.T[i][c]), a.L[c][i] = float(own.L[i][c]);
  return deviation(some, a, truth_of(some), white_, some.count).color.max;
}

double Judge::seconds_per_ray(const Rays& rays) const {
  const Rays some = few_of(rays);
  const auto begin = std::chrono::steady_clock::now();
  (void)judge(some);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  return took.count() / double(some.count);
}

std::string Judge::describe() const {
  if (!by_ray_)
    return "the truth: one adaptive march in double through the media's physics at "
           "points";
  return "brume itself at its finest, every ray asked for itself without the tables of a "
         "frame: the truth at points is another model of the sky";
}

}  // namespace brume::study
