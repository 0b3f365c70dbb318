#include "study/pixel_subject.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>

#include "pipeline/rows.h"
#include "study/pixel_way.h"
#include "study/reference.h"
#include "truth/shown.h"

namespace brume::study {

namespace {

constexpr std::size_t kHunted = 16;  // pixels that each way adds where it is worst
constexpr int kChunk = 64;           // pixels asked of the truth at once

double error_at(const Candidate& one, std::size_t at, const double want[3],
                double white) {
  double worst = 0;
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(want[k])) continue;
    const double off = std::abs(double(one.out[k][at]) - want[k]);
    worst =
        std::max(worst, (std::isnan(off) ? HUGE_VAL : off) / (white + std::abs(want[k])));
  }
  return worst;
}

// Where each way is farthest from ours.
std::vector<std::uint32_t> hunt(const Sheet& s, const std::vector<Line>& lines,
                                double white) {
  std::vector<std::uint32_t> out;
  const Candidate& ours = lines[0].candidates.back();
  for (const Line& line : lines)
    for (const Candidate& one : line.candidates) {
      if (&one == &ours) continue;
      std::vector<std::pair<double, std::uint32_t>> apart;
      for (int i = 0; i < s.size(); ++i) {
        const std::size_t at = s.at(i);
        const double want[3] = {double(ours.out[0][at]), double(ours.out[1][at]),
                                double(ours.out[2][at])};
        apart.emplace_back(error_at(one, at, want, white), std::uint32_t(i));
      }
      const std::size_t most = std::min(kHunted, apart.size());
      std::partial_sort(apart.begin(), apart.begin() + std::ptrdiff_t(most), apart.end(),
                        std::greater<>());
      for (std::size_t k = 0; k < most; ++k) out.push_back(apart[k].second);
    }
  // Bright ones too: most of what there is comes from them.
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// What is right at pixels, three numbers each.
std::vector<double> truth_of(const RunningStage& stage, Sheet& sheet,
                             const std::vector<std::uint32_t>& pixels,
                             const brume_world* world) {
  std::vector<double> rgb(3 * pixels.size());
  const Sheet::Tile tile = sheet.tile(world);
  const std::size_t chunks = (pixels.size() + kChunk - 1) / kChunk;
  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t k) {
    const std::size_t begin = k * kChunk, end = std::min(pixels.size(), begin + kChunk);
    std::vector<int> xy;
    for (std::size_t i = begin; i < end; ++i) {
      xy.push_back(int(pixels[i]) % sheet.width);
      xy.push_back(int(pixels[i]) / sheet.width);
    }
    stage.instance->truth(tile, xy, &rgb[3 * begin]);
  });
  return rgb;
}

std::vector<std::uint32_t> grid_of(const Sheet& s, std::size_t most, Subject& subject) {
  const double scale = std::sqrt(double(most) / s.size());
  const int w = subject.grid_width = std::clamp(int(s.width * scale), 1, s.width);
  const int h = subject.grid_height = std::clamp(int(s.height * scale), 1, s.height);
  std::vector<std::uint32_t> out;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      out.push_back(std::uint32_t((2 * y + 1) * s.height / (2 * h)) *
                        std::uint32_t(s.width) +
                    std::uint32_t((2 * x + 1) * s.width / (2 * w)));
  return out;
}

}  // namespace

std::optional<Subject> study_of_pixels(const Context& c, const std::string& name,
                                       const SceneFile& scene, Registry& registry,
                                       const FrameFiles& files, std::string& why_not) {
  const RunningStage& stage = *find_stage(c.given, name);
  if (!stage.instance->type().table.truth) {
    why_not = "has no truth to be held against";
    return {};
  }
  if (stage.mask >= 0 || stage.mix != 1) {
    why_not = "is studied without mask and mix alone";
    return {};
  }
  std::optional<Sheet> sheet = sheet_of(c, stage, name, scene, registry, files, why_not);
  if (!sheet) return {};
  Subject subject;
  subject.name = name;
  c.say(name + ": times");
  const double truths_from = c.left() - c.timing_seconds;
  std::vector<Line> lines;
  add_ours(c, name, *sheet, lines);
  if (c.options.baselines) add_others(stage, *sheet, lines, subject);

  // Times: every way in turn on the whole frame, while there is time, twice at least.
  for (int r = 0; r < c.options.repeats && (r < 2 || c.left() > truths_from); ++r)
    for (Line& line : lines)
      for (Candidate& one : line.candidates) one.seconds.push_back(run(one, *sheet));
  for (Line& line : lines)
    for (Candidate& one : line.candidates) {
      Point& p = one.point;
      const Spread s = spread(one.seconds);
      p.once = std::max(p.once - s.median, 0.);
      p.per_pixel = {s.low / c.pixels, s.median / c.pixels, s.high / c.pixels};
      p.seconds = s.median;
    }

  c.say(name + ": truth");
  const truth::Shown shown(c.given.impl().world);
  const brume_world* world = stage.role == BRUME_SURFACE ? &shown.table() : nullptr;
  const auto begin = std::chrono::steady_clock::now();
  Subject trial;
  (void)truth_of(stage, *sheet, grid_of(*sheet, 2 * kChunk, trial), world);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::vector<std::uint32_t> worst = hunt(*sheet, lines, c.white);
  const auto can = std::size_t(std::max(0., 0.8 * c.left()) /
                               std::max(took.count() / (2 * kChunk), 1e-9));
  if (worst.size() > can / 2) worst.resize(std::max<std::size_t>(can / 2, 16));
  const std::size_t most = std::clamp<std::size_t>(can - std::min(can, worst.size()), 64,
                                                   std::size_t(c.options.pixels));
  std::vector<std::uint32_t> chosen = grid_of(*sheet, most, subject);
  const std::size_t even = chosen.size();
  chosen.insert(chosen.end(), worst.begin(), worst.end());
  const std::vector<double> right = truth_of(stage, *sheet, chosen, world);
  subject.reference = "the stage's own truth, every pixel by itself in double";
  subject.rays = chosen.size();

  for (Line& line : lines) {
    Method method{line.kind, line.name, {}};
    for (Candidate& one : line.candidates) {
      std::vector<double> errors;
      std::size_t farthest = 0;
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        errors.push_back(
            error_at(one, sheet->at(int(chosen[i])), &right[3 * i], c.white));
        if (errors.back() > errors[farthest]) farthest = i;
      }
      Point p = std::move(one.point);
      const std::vector<double> on_grid(errors.begin(),
                                        errors.begin() + std::ptrdiff_t(even));
      p.color = error_of(on_grid);
      p.color.max = errors[farthest];
      p.T.max = p.L.max = NAN;  // there are no rays here
      p.x = c.rays.x[chosen[farthest]], p.y = c.rays.y[chosen[farthest]];
      p.map.assign(on_grid.begin(), on_grid.end());
      method.points.push_back(std::move(p));
    }
    subject.methods.push_back(std::move(method));
  }
  return subject;
}

}  // namespace brume::study
