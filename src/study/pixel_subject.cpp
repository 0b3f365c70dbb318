#include "study/pixel_subject.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>

#include "num/error.h"
#include "pipeline/proxy.h"
#include "pipeline/rows.h"
#include "stage/registry.h"
#include "stress/shown.h"
#include "study/reference.h"

namespace brume::study {

namespace {

constexpr int kLargestWindow = 64;   // pixels to each side
constexpr double kLongest = 20;      // [s] for a frame: more nobody waits
constexpr std::size_t kHunted = 16;  // pixels that each way adds where it is worst
constexpr int kChunk = 64;           // pixels asked of the truth at once

// A frame's planes with `around` copies of its edge on each side.
struct Sheet {
  int width = 0, height = 0, around = 0;
  std::ptrdiff_t stride = 0;
  std::vector<float> rgb[3], alpha, t, d[3], o[3];
  std::vector<std::vector<float>> channels;
  std::vector<const float*> channels_at;

  std::size_t at(int x, int y) const {
    return std::size_t((y + around) * stride + x + around);
  }
  std::size_t at(std::uint32_t i) const { return at(int(i) % width, int(i) / width); }
  std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }

  /// A plane of width x height, laid out; empty stays empty.
  std::vector<float> lay(const std::vector<float>& plane) const {
    std::vector<float> out;
    if (plane.empty()) return out;
    out.resize(std::size_t(stride * (height + 2 * around)));
    for (int y = -around; y < height + around; ++y)
      for (int x = -around; x < width + around; ++x)
        out[at(x, y)] =
            plane[std::size_t(std::clamp(y, 0, height - 1)) * std::size_t(width) +
                  std::size_t(std::clamp(x, 0, width - 1))];
    return out;
  }

  brume_tile tile(const brume_world* world) {
    const std::size_t first = at(0, 0);
    const auto plane = [&](std::vector<float>& v) {
      return v.empty() ? nullptr : v.data() + first;
    };
    channels_at.clear();
    for (auto& c : channels) channels_at.push_back(plane(c));
    brume_tile tile{};
    tile.size = sizeof tile;
    tile.width = width, tile.height = height;
    tile.row_stride = stride;
    tile.r = plane(rgb[0]), tile.g = plane(rgb[1]), tile.b = plane(rgb[2]);
    tile.a = plane(alpha);
    tile.distance = plane(t);
    tile.dx = plane(d[0]), tile.dy = plane(d[1]), tile.dz = plane(d[2]);
    tile.ox = plane(o[0]), tile.oy = plane(o[1]), tile.oz = plane(o[2]);
    tile.channels = channels_at.data();
    tile.world = world;
    return tile;
  }
};

const RunningStage* find(const Prepared& p, const std::string& name) {
  const PreparedFrame::Impl& f = p.impl();
  for (std::size_t k = 0; k < f.stages.size(); ++k)
    if (stage_name(f, k) == name) return &f.stages[k];
  return nullptr;
}

// The picture that a lens stage is given: everything before it applied.
Image before_lens(const std::string& name, const SceneFile& scene, Registry& registry,
                  const FrameFiles& files) {
  SceneFile less = scene;
  less.stages.clear();
  bool found = false;
  for (const StageEntry& s : scene.stages) {
    found = found || s.name == name;
    if (!found || registry.find(s.type).role != BRUME_LENS) less.stages.push_back(s);
  }
  FrameReport ignored;
  const ApplyOptions whole;
  FrameSource source = files.source(whole);
  source.best_effort = true;
  return render_part(Session(less, registry).prepare(source), files, whole, ignored);
}

// What the stage reads; nothing where that cannot be had.
std::optional<Sheet> sheet_of(const Context& c, const RunningStage& stage,
                              const std::string& name, const SceneFile& scene,
                              Registry& registry, const FrameFiles& files,
                              std::string& why_not) {
  const PreparedFrame::Impl& f = c.given.impl();
  const Window data = files.main().header().data_window;
  Sheet s;
  s.width = data.width, s.height = data.height;
  s.around = std::max(stage.needs.rows_around, stage.needs.columns_around);
  s.stride = s.width + 2 * s.around;
  const std::size_t n = s.pixels();
  if (c.rays.count != n) {
    why_not = "the frame is too large to study what its pixels do to each other";
    return {};
  }
  std::vector<float> rgb[3], alpha(n, 1.f);
  if (stage.role == BRUME_LENS) {
    const Image image = before_lens(name, scene, registry, files);
    for (std::size_t k = 0; k < 3; ++k) {
      const int at = f.color[k] < 0
                         ? -1
                         : image.header.find(f.inputs[std::size_t(f.color[k])].channel);
      if (at < 0) {
        why_not = "the frame has no colour";
        return {};
      }
      const auto plane = image.plane(at);
      rgb[k].assign(plane.begin(), plane.end());
    }
  } else {
    for (int k = 0; k < 3; ++k)
      rgb[k].assign(c.rays.S[k].begin(), c.rays.S[k].begin() + std::ptrdiff_t(n));
  }
  if (f.alpha >= 0) alpha = files.read_all(f.inputs[std::size_t(f.alpha)], data, false);
  for (int k = 0; k < 3; ++k) s.rgb[k] = s.lay(rgb[k]);
  s.alpha = s.lay(alpha);
  if (stage.role == BRUME_SURFACE) {
    s.t = s.lay(c.rays.t);
    for (int k = 0; k < 3; ++k) s.d[k] = s.lay(c.rays.d[k]), s.o[k] = s.lay(c.rays.o[k]);
  }
  for (const int channel : stage.channels)
    s.channels.push_back(
        channel < 0 ? std::vector<float>()
                    : s.lay(files.read_all(f.inputs[std::size_t(channel)], data, false)));
  return s;
}

// A way to change the pixels, and what it made of them.
using PixelWay = std::function<void(Sheet&)>;
struct Candidate {
  PixelWay way;
  Point point;
  std::vector<float> out[3];  // of the sheet's layout
  std::vector<double> seconds;
};
struct Line {
  MethodKind kind;
  std::string name;
  std::vector<Candidate> candidates;
};

// Runs it once on a fresh copy; seconds of all cores.
double run(Candidate& one, const Sheet& given) {
  Sheet s = given;
  const double begin = process_seconds();
  one.way(s);
  const double took = process_seconds() - begin;
  for (int k = 0; k < 3; ++k) one.out[k] = std::move(s.rgb[k]);
  return took;
}

// The pattern that a lens makes of a single pixel in the middle, as a sum over windows of
// so many pixels to each side.
PixelWay windowed(const RunningStage& stage, int reach) {
  const auto pattern = std::make_shared<std::vector<float>>();
  return [&stage, reach, pattern](Sheet& s) {
    const int side = 2 * reach + 1;
    if (pattern->empty()) {
      Sheet one;
      one.width = s.width, one.height = s.height, one.stride = s.width;
      const std::size_t middle = one.at(s.width / 2, s.height / 2);
      for (auto& plane : one.rgb) plane.assign(one.pixels(), 0.f), plane[middle] = 1e6f;
      one.alpha.assign(one.pixels(), 1.f);
      one.channels = s.channels;
      stage.instance->run(one.tile(nullptr));
      pattern->resize(std::size_t(3 * side * side));
      for (int c = 0, k = 0; c < 3; ++c)
        for (int dy = -reach; dy <= reach; ++dy)
          for (int dx = -reach; dx <= reach; ++dx, ++k) {
            const int x = s.width / 2 + dx, y = s.height / 2 + dy;
            if (x >= 0 && x < s.width && y >= 0 && y < s.height)
              (*pattern)[std::size_t(k)] = one.rgb[c][one.at(x, y)] / 1e6f;
          }
    }
    for (int c = 0; c < 3; ++c) {
      const std::vector<float> in = s.rgb[c];
      const float* const K = pattern->data() + c * side * side;
      tbb::parallel_for(0, s.height, [&](int y) {
        std::vector<float> row(std::size_t(s.width));
        for (int dy = -reach; dy <= reach; ++dy) {
          if (y - dy < 0 || y - dy >= s.height) continue;
          const float* from = &in[s.at(0, y - dy)];
          for (int dx = -reach; dx <= reach; ++dx) {
            const float w = K[(dy + reach) * side + dx + reach];
            const int x0 = std::max(0, dx), x1 = std::min(s.width, s.width + dx);
            for (int x = x0; x < x1; ++x) row[std::size_t(x)] += w * from[x - dx];
          }
        }
        std::copy(row.begin(), row.end(), &s.rgb[c][s.at(0, y)]);
      });
    }
  };
}

bool same(const Candidate& a, const Candidate& b) {
  return std::equal(std::begin(a.out), std::end(a.out), std::begin(b.out));
}

// Ours along the tolerance and the stage's own knob; settings of the same bits once.
void add_ours(const Context& c, const std::string& name, const Sheet& sheet,
              std::vector<Line>& lines) {
  std::vector<const Prepared*> settings;
  for (const Prepared& p : c.settings)
    if (p.knob.empty() || p.knob.starts_with(name + ".")) settings.push_back(&p);
  settings.push_back(&c.given);
  std::size_t distinct = 0;
  for (const Prepared* p : settings) {
    const RunningStage* stage = find(*p, name);
    if (!stage) continue;
    Candidate one;
    one.way = [stage, p](Sheet& s) {
      const brume_world world = world_for_stages(p->impl());
      stage->instance->run(s.tile(stage->role == BRUME_SURFACE ? &world : nullptr));
    };
    one.point.setting = p->setting;
    one.point.set = p->set;
    one.point.once = run(one, sheet);
    bool known = false;
    for (const Line& line : lines)
      for (const Candidate& other : line.candidates) known = known || same(other, one);
    if (known) continue;
    const std::string title = p->knob.empty() ? "brume" : "brume, " + p->knob;
    distinct += p->knob.empty();
    const auto line = std::find_if(lines.begin(), lines.end(),
                                   [&](const Line& l) { return l.name == title; });
    if (line != lines.end()) {
      line->candidates.push_back(std::move(one));
      continue;
    }
    lines.push_back({MethodKind::ours, title, {}});
    lines.back().candidates.push_back(std::move(one));
  }
  if (distinct > 1) return;
  lines[0].candidates[0].point.setting = "any tolerance";
  lines[0].candidates[0].point.set.clear();
}

void add_others(const RunningStage& stage, const Sheet& sheet, std::vector<Line>& lines,
                Subject& subject) {
  if (stage.instance->type().table.baseline_run) {
    Candidate one;
    one.way = [&stage](Sheet& s) { stage.instance->run_baseline(s.tile(nullptr)); };
    one.point.setting = "as published";
    try {
      one.point.once = run(one, sheet);
      lines.push_back({MethodKind::source, stage.instance->type().baseline, {}});
      lines.back().candidates.push_back(std::move(one));
    } catch (const Error& e) {
      subject.notes.push_back("no source to compare with: " + e.what_found);
    }
  }
  if (!(stage.needs.laws & BRUME_LINEAR)) return;
  Line line{MethodKind::marching, "its pattern summed over a window", {}};
  for (int reach = 1; reach <= kLargestWindow; reach *= 2) {
    Candidate one;
    one.way = windowed(stage, reach);
    one.point.setting = fmt::format("{0} x {0} pixels", 2 * reach + 1);
    one.point.once = run(one, sheet);
    const double took = one.point.once;
    line.candidates.push_back(std::move(one));
    if (4 * took > kLongest) break;
  }
  lines.push_back(std::move(line));
}

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
      for (std::uint32_t i = 0; i < s.pixels(); ++i) {
        const std::size_t at = s.at(i);
        const double want[3] = {double(ours.out[0][at]), double(ours.out[1][at]),
                                double(ours.out[2][at])};
        apart.emplace_back(error_at(one, at, want, white), i);
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
  const brume_tile tile = sheet.tile(world);
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
  const double scale = std::sqrt(double(most) / double(s.pixels()));
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
  const RunningStage& stage = *find(c.given, name);
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
  std::vector<Line> lines;
  add_ours(c, name, *sheet, lines);
  if (c.options.baselines) add_others(stage, *sheet, lines, subject);

  // Times: every way in turn on the whole frame, while there is time, twice at least.
  double left = c.timing_seconds;
  for (int r = 0; r < c.options.repeats && (r < 2 || left > 0); ++r)
    for (Line& line : lines)
      for (Candidate& one : line.candidates) {
        one.seconds.push_back(run(one, *sheet));
        left -= one.seconds.back();
      }
  for (Line& line : lines)
    for (Candidate& one : line.candidates) {
      Point& p = one.point;
      const Spread s = spread(one.seconds);
      p.once = std::max(p.once - s.median, 0.);
      p.per_pixel = {s.low / c.pixels, s.median / c.pixels, s.high / c.pixels};
      p.seconds = s.median;
    }

  c.say(name + ": truth");
  AirOptions o;
  o.tolerance = c.finest.tolerance;
  o.white = c.white;
  o.stages = int(c.given.impl().stages.size());
  std::unique_ptr<stress::Shown> shown;
  if (stage.role == BRUME_SURFACE)
    shown = std::make_unique<stress::Shown>(c.given.impl().world, o);
  const brume_world* world = shown ? &shown->truth() : nullptr;
  const auto begin = std::chrono::steady_clock::now();
  Subject trial;
  (void)truth_of(stage, *sheet, grid_of(*sheet, 2 * kChunk, trial), world);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::vector<std::uint32_t> worst = hunt(*sheet, lines, c.white);
  const auto can =
      std::size_t(c.truth_seconds / std::max(took.count() / (2 * kChunk), 1e-9));
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
        errors.push_back(error_at(one, sheet->at(chosen[i]), &right[3 * i], c.white));
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
