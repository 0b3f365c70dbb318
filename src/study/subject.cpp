#include "study/subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <thread>

#include "num/error.h"
#include "study/reference.h"

namespace brume::study {

namespace {

constexpr int kMostSteps = 512;
constexpr double kLongest = 20;      // [s] for a frame: more steps than that nobody takes
constexpr double kSkyEnds = 1e6;     // [m] where a ray into the sky has seen all of it
constexpr std::size_t kHunted = 16;  // pixels that each way adds where it is worst

// A point and how to compute it.
struct Candidate {
  Way way;
  Point point;
};
struct Line {
  MethodKind kind;
  std::string name;
  std::vector<Candidate> candidates;
};

bool same(const Answers& a, const Answers& b) {
  for (std::size_t c = 0; c < 3; ++c)
    for (const auto& [x, y] : {std::pair(&a.T[c], &b.T[c]), {&a.L[c], &b.L[c]}})
      if (std::memcmp(x->data(), y->data(), x->size() * sizeof(float)) != 0) return false;
  return true;
}

// Ours along each knob, a line for each. Settings that give the same bits are one point.
void add_ours(const Context& c, const std::string& stage, const Rays& some,
              std::vector<Line>& lines) {
  std::vector<Answers> seen;
  std::size_t distinct = 0;
  const auto add = [&](const Prepared& p) {
    Candidate one;
    one.way = ours(air_of(p, stage, c.white));
    const Answers a = evaluate(one.way, some);
    if (std::any_of(seen.begin(), seen.end(),
                    [&](const Answers& s) { return same(s, a); }))
      return;
    seen.push_back(a);
    const std::string line = p.knob.empty() ? "brume" : "brume, " + p.knob;
    distinct += p.knob.empty();
    one.point.setting = p.setting;
    one.point.set = p.set;
    if (stage.empty()) one.point.once = p.once, one.point.frame = p.frame;
    const auto at = std::find_if(lines.begin(), lines.end(),
                                 [&](const Line& l) { return l.name == line; });
    if (at != lines.end()) return at->candidates.push_back(std::move(one));
    lines.push_back({MethodKind::ours, line, {}});
    lines.back().candidates.push_back(std::move(one));
  };
  for (const Prepared& p : c.settings) add(p);
  add(c.given);
  if (distinct > 1) return;
  lines[0].candidates[0].point.setting = "any tolerance";
  lines[0].candidates[0].point.set.clear();
}

// Some rays, spread over the frame.
Rays evenly(const Rays& rays, std::size_t n) {
  std::vector<std::uint32_t> out;
  n = std::min(n, rays.count);
  for (std::size_t k = 0; k < n; ++k)
    out.push_back(std::uint32_t((2 * k + 1) * rays.count / (2 * n)));
  return rays.pick(out);
}

// Of the processor, per ray.
double seconds_of(const Way& way, const Rays& rays) {
  const double begin = process_seconds();
  (void)evaluate(way, rays);
  return (process_seconds() - begin) / double(rays.count);
}

// Rays spread over the frame, as many as ours takes a tenth of a second for, or of short
// time a 400th.
Rays some_rays(const Context& c, const std::string& stage) {
  const Rays few = evenly(c.rays, 256);
  const Way way = ours(air_of(c.given, stage, c.white));
  (void)evaluate(way, few);
  const double one = std::max(seconds_of(way, few), 1e-9);
  return evenly(c.rays, std::size_t(std::clamp(
                            std::min(0.1, c.timing_seconds / 400) / one, 256., 65536.)));
}

// The source's own way, or why it has none.
void add_source(const Context& c, const std::string& stage, const Rays& few,
                std::vector<Line>& lines, Subject& subject) {
  const PreparedFrame::Impl& f = c.given.impl();
  for (std::size_t k = 0; k < f.stages.size(); ++k) {
    if (stage_name(f, k) != stage) continue;
    const StageInstance& instance = *f.stages[k].instance;
    if (instance.type().baseline.empty()) return;
    if (!c.rays.weights[k].empty()) {
      subject.notes.push_back("its source document knows neither mask nor mix");
      return;
    }
    try {
      Candidate one;
      one.way = of_source(instance);
      (void)evaluate(one.way, few);
      one.point.setting = "as published";
      lines.push_back({MethodKind::source, instance.type().baseline, {}});
      lines.back().candidates.push_back(std::move(one));
    } catch (const Error& e) {
      subject.notes.push_back("no source to compare with: " + e.what_found);
    }
  }
}

void add_baselines(const Context& c, const std::string& stage, const Rays& few,
                   std::vector<Line>& lines, Subject& subject) {
  const World world = world_of(c.given, stage);
  const auto air = air_of(c.given, stage, c.white);
  try {
    Line line{MethodKind::marching, "even steps", {}};
    const bool sky = std::any_of(world.media.begin(), world.media.end(),
                                 [](const auto& m) { return m.what.is_sky; });
    double took = 0;  // [s per ray]
    for (int steps = 1; steps <= kMostSteps; steps *= 2) {
      if (2 * took * c.pixels > kLongest) break;
      Candidate one;
      one.way = marching(air, steps, float(sky ? std::max(c.far, kSkyEnds) : c.far));
      took = seconds_of(one.way, few);
      one.point.setting = steps == 1 ? "1 step" : fmt::format("{} steps", steps);
      line.candidates.push_back(std::move(one));
    }
    lines.push_back(std::move(line));
  } catch (const Error& e) {
    subject.notes.push_back(e.what());
  }
  if (world.media.size() < 2 || !world.interfaces.empty()) return;
  AirOptions o;
  o.tolerance = c.given.tolerance;
  o.white = c.white;
  o.stages = int(c.given.impl().stages.size());
  Candidate one;
  one.way = painting(world, o);
  one.point.setting = fmt::format("{} layers", world.media.size());
  (void)evaluate(one.way, few);
  lines.push_back({MethodKind::painting, "one painted over the other", {}});
  lines.back().candidates.push_back(std::move(one));
}

// Indices of an even grid of about `most` pixels; the grid's size.
std::vector<std::uint32_t> grid_of(const Rays& rays, std::size_t most, int& width,
                                   int& height) {
  const int columns = rays.x[rays.count - 1] - rays.x[0] + 1;
  const int rows = int(rays.count) / columns;
  const int span = rays.y[rays.count - 1] - rays.y[0] + 1;
  const double scale = std::sqrt(double(most) / (double(columns) * double(span)));
  width = std::clamp(int(columns * scale), 1, columns);
  height = std::clamp(int(span * scale), 1, rows);
  std::vector<std::uint32_t> out;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out.push_back(std::uint32_t((2 * y + 1) * rows / (2 * height)) *
                        std::uint32_t(columns) +
                    std::uint32_t((2 * x + 1) * columns / (2 * width)));
  return out;
}

// Where on the frame each way differs most from ours at its finest.
std::vector<std::uint32_t> hunt(const Context& c, const Way& finest,
                                const std::vector<Line>& lines) {
  std::size_t ways = 0;
  for (const Line& line : lines) ways += line.candidates.size();
  const double each = std::clamp(0.2 * c.left() / double(ways), 0.01, 0.5);
  const double cores = std::max(1u, std::thread::hardware_concurrency());
  const double slowest = lines[0].candidates.back().point.per_pixel.median;
  // Ours at its finest may be slower by far.
  const double finest_one = seconds_of(finest, evenly(c.rays, 64));
  const auto most = std::size_t(std::max(
      64.,
      cores * std::min(each / slowest, 0.1 * c.left() / std::max(finest_one, 1e-9))));
  const std::size_t stride = (c.rays.count + most - 1) / most;
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < c.rays.count; i += stride)
    indices.push_back(std::uint32_t(i));
  const Rays rays = c.rays.pick(indices);
  const Answers right = evaluate(finest, rays);
  std::vector<std::uint32_t> out;
  for (const Line& line : lines)
    for (const Candidate& one_of : line.candidates) {
      if (one_of.point.per_pixel.median * double(rays.count) / cores > each) continue;
      for (const std::uint32_t i :
           farthest_apart(rays, evaluate(one_of.way, rays), right, c.white, kHunted))
        out.push_back(indices[i]);
    }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

std::string stage_name(const PreparedFrame::Impl& f, std::size_t k) {
  return f.plan.stages[std::size_t(f.stages[k].plan)].name;
}

Subject study_of(const Context& c, const std::string& stage, const std::string& title) {
  Subject subject;
  subject.name = title;
  subject.whole = stage.empty();
  c.say(title + ": times");
  const double truths_from = c.left() - c.timing_seconds;

  std::vector<Line> lines;
  const Rays some = some_rays(c, stage);
  add_ours(c, stage, some, lines);
  if (c.options.baselines) {
    std::vector<std::uint32_t> first(std::min<std::size_t>(256, some.count));
    std::iota(first.begin(), first.end(), 0u);
    const Rays few = some.pick(first);
    add_source(c, stage.empty() && title != "scene" ? title : stage, few, lines, subject);
    add_baselines(c, stage, few, lines, subject);
  }

  // Times: every way in turn, round after round.
  std::size_t ways = 0;
  for (const Line& line : lines) ways += line.candidates.size();
  Stopwatch watch(c.rays);
  const double each =
      std::clamp(c.timing_seconds / double(ways) / double(c.options.repeats), 1e-4, 0.02);
  for (const Line& line : lines)
    for (const Candidate& one : line.candidates) watch.add(one.way, each);
  int rounds = 0;
  while (rounds < c.options.repeats && (rounds < 3 || c.left() > truths_from))
    watch.round(), ++rounds;
  if (rounds < c.options.repeats)
    subject.notes.push_back(
        fmt::format("timed {} times only: there was no time", rounds));
  std::size_t number = 0;
  for (Line& line : lines)
    for (Candidate& one : line.candidates) {
      Point& p = one.point;
      p.per_pixel = watch.per_pixel(number);
      p.frame += watch.first(number++);
      p.seconds = p.frame + c.pixels * p.per_pixel.median;
    }

  // What is right: an even grid, and wherever a way is farthest off.
  c.say(title + ": truth");
  const Judge judge(c.finest, c.by_ray, stage, c.white);
  std::vector<std::uint32_t> worst =
      hunt(c, ours(air_of(c.finest, stage, c.white)), lines);
  double one = judge.seconds_per_ray(c.rays);  // and every way is asked of it as well
  for (const Line& line : lines)
    for (const Candidate& each_of : line.candidates)
      one += each_of.point.per_pixel.median /
             std::max(1u, std::thread::hardware_concurrency());
  const auto can = std::size_t(std::max(0., 0.8 * c.left()) / std::max(one, 1e-9));
  if (worst.size() > can / 2) {  // evenly fewer
    std::vector<std::uint32_t> kept;
    const std::size_t n = std::max<std::size_t>(can / 2, 16);
    for (std::size_t k = 0; k < std::min(n, worst.size()); ++k)
      kept.push_back(worst[k * worst.size() / std::min(n, worst.size())]);
    worst = kept;
  }
  const std::size_t most = std::clamp<std::size_t>(can - std::min(can, worst.size()), 64,
                                                   std::size_t(c.options.pixels));
  std::vector<std::uint32_t> chosen =
      grid_of(c.rays, most, subject.grid_width, subject.grid_height);
  const std::size_t even = chosen.size();
  chosen.insert(chosen.end(), worst.begin(), worst.end());
  const Rays held = c.rays.pick(chosen);
  const Reference right = judge.judge(held);
  subject.reference = judge.describe();
  subject.reference_error = right.error;
  subject.rays = held.count;
  if (const double gap = judge.model_gap(c.rays); gap > 0)
    subject.notes.push_back(fmt::format(
        "the truth, which knows the sky's extinction by three colours at a point where "
        "the "
        "stage goes by wavelengths along a ray, parts from that by up to about {:.1g}",
        gap));
  if (right.unconverged > 0)
    subject.notes.push_back(
        fmt::format("the truth did not converge on {} rays", right.unconverged));

  for (Line& line : lines) {
    Method method{line.kind, line.name, {}};
    for (Candidate& candidate : line.candidates) {
      const Deviation d =
          deviation(held, evaluate(candidate.way, held), right, c.white, even);
      Point p = std::move(candidate.point);
      p.color = d.color, p.T = d.T, p.L = d.L;
      p.x = held.x[d.worst], p.y = held.y[d.worst];
      p.map.assign(d.color_by_ray.begin(), d.color_by_ray.begin() + std::ptrdiff_t(even));
      method.points.push_back(std::move(p));
    }
    subject.methods.push_back(std::move(method));
  }
  return subject;
}

}  // namespace brume::study
