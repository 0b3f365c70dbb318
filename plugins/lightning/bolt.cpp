#include "bolt.h"

#include <algorithm>
#include <cmath>

#include "num/random.h"

namespace lightning {
namespace {

Vec3 mix(const Vec3& a, const Vec3& b, double w) {
  return {a[0] + w * (b[0] - a[0]), a[1] + w * (b[1] - a[1]), a[2] + w * (b[2] - a[2])};
}
double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
}
double length(const std::vector<Vec3>& line) {
  double sum = 0;
  for (std::size_t i = 1; i < line.size(); ++i) sum += distance(line[i - 1], line[i]);
  return sum;
}

// Evenly in the ball of this radius.
Vec3 in_ball(brume::Random& random, double radius) {
  Vec3 v;
  do
    for (double& x : v) x = random.uniform(-1, 1);
  while (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] > 1);
  for (double& x : v) x *= radius;
  return v;
}

std::vector<Vec3> broken(std::vector<Vec3> line, int times, double roughness,
                         brume::Random& random) {
  for (int k = 0; k < times; ++k) {
    std::vector<Vec3> finer = {line[0]};
    for (std::size_t i = 1; i < line.size(); ++i) {
      Vec3 m = mix(line[i - 1], line[i], 0.5);
      const Vec3 off = in_ball(random, roughness * distance(line[i - 1], line[i]));
      for (std::size_t c = 0; c < 3; ++c) m[c] += off[c];
      finer.push_back(m);
      finer.push_back(line[i]);
    }
    line = std::move(finer);
  }
  return line;
}

}  // namespace

std::vector<Spark> along_line(const std::vector<Vec3>& points, int count) {
  const double all = length(points);
  std::vector<Spark> sparks;
  std::size_t i = 1;
  double before = 0, here = distance(points[0], points[1]);
  for (int k = 0; k < count; ++k) {
    const double s = all * (k + 0.5) / count;
    while (before + here < s && i + 1 < points.size()) {
      before += here;
      ++i;
      here = distance(points[i - 1], points[i]);
    }
    const double w = here > 0 ? std::min((s - before) / here, 1.) : 0;
    sparks.push_back({mix(points[i - 1], points[i], w), 1. / count});
  }
  return sparks;
}

std::vector<std::vector<Vec3>> grow(const std::vector<Vec3>& points, const Bolt& bolt) {
  brume::Random random{std::uint64_t(bolt.seed)};
  std::vector<std::vector<Vec3>> lines = {broken(points, 6, bolt.roughness, random)};
  const Vec3 first = points.front(), last = points.back();
  for (int b = 0; b < bolt.branches; ++b) {
    // From somewhere on the trunk, on towards its end but astray.
    const std::vector<Vec3>& trunk = lines[0];
    const auto at = std::size_t(random.uniform(0.1, 0.8) * double(trunk.size() - 1));
    const double reach = random.uniform(0.1, 0.35);
    Vec3 end = trunk[at];
    const Vec3 off = in_ball(random, reach * 0.7 * distance(first, last));
    for (std::size_t c = 0; c < 3; ++c) end[c] += reach * (last[c] - first[c]) + off[c];
    lines.push_back(broken({trunk[at], end}, 4, bolt.roughness, random));
  }
  return lines;
}

std::vector<Spark> along_lines(const std::vector<std::vector<Vec3>>& lines, int count) {
  double all = 0;
  std::vector<double> weight;
  for (const auto& line : lines) {
    weight.push_back(length(line) * (weight.empty() ? 1 : 0.5));
    all += weight.back();
  }
  std::vector<Spark> sparks;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double part = all > 0 ? weight[i] / all : i == 0;
    if (!(part > 0)) continue;
    for (Spark s : along_line(lines[i], std::max(1, int(std::lround(part * count))))) {
      s.share *= part;
      sparks.push_back(s);
    }
  }
  return sparks;
}

}  // namespace lightning
