#include "study/pixel_way.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

#include "num/error.h"
#include "pipeline/rows.h"
#include "stage/registry.h"

namespace brume::study {
namespace {

constexpr int kLargestWindow = 64;  // pixels to each side
constexpr double kLongest = 20;     // [s] for a frame: more nobody waits

// The pattern that a lens makes of a single pixel in the middle, as a sum over windows of
// so many pixels to each side.
PixelWay windowed(const RunningStage& stage, int reach) {
  const auto pattern = std::make_shared<std::vector<float>>();
  return [&stage, reach, pattern](Sheet& s) {
    const int side = 2 * reach + 1;
    if (pattern->empty()) {
      Sheet one;
      one.resize(s.width, s.height, 0);
      for (auto& plane : one.rgb) plane[one.at(s.width / 2, s.height / 2)] = 1e6f;
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

}  // namespace

double run(Candidate& one, const Sheet& given) {
  Sheet s = given;
  const double begin = process_seconds();
  one.way(s);
  const double took = process_seconds() - begin;
  for (int k = 0; k < 3; ++k) one.out[k] = std::move(s.rgb[k]);
  return took;
}

void add_ours(const Context& c, const std::string& name, const Sheet& sheet,
              std::vector<Line>& lines) {
  std::vector<const Prepared*> settings;
  for (const Prepared& p : c.settings)
    if (p.knob.empty() || p.knob.starts_with(name + ".")) settings.push_back(&p);
  settings.push_back(&c.given);
  std::size_t distinct = 0;
  for (const Prepared* p : settings) {
    const RunningStage* stage = find_stage(*p, name);
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

}  // namespace brume::study
