#include "air/segment.h"

#include <algorithm>
#include <cstddef>

#include "air/cull.h"

namespace brume::air {
namespace {

/// Room that a thread keeps: planes of kBlock floats, handed out in order.
class Room {
 public:
  void start(std::size_t planes, std::size_t bytes) {
    const std::size_t want = planes * kBlock * sizeof(float) + bytes + 128;
    if (data_.size() < want) data_.resize(want);
    const auto address = reinterpret_cast<std::uintptr_t>(data_.data());
    next_ = data_.data() + (64 - address % 64) % 64;
  }
  float* plane() {
    float* p = reinterpret_cast<float*>(next_);
    next_ += kBlock * sizeof(float);
    return p;
  }
  void* rest() { return next_; }

 private:
  std::vector<std::byte> data_;
  std::byte* next_ = nullptr;
};

void fill(float* p, int n, float x) { std::fill(p, p + n, x); }

/// A block from one of its rays on. (Of thousands of stages its planes are many: they are
/// not moved.)
struct Part {
  const Block& b;
  int begin = 0;
  float* T[3] = {b.T[0] + begin, b.T[1] + begin, b.T[2] + begin};
  float* L[3] = {b.L[0] + begin, b.L[1] + begin, b.L[2] + begin};

  const float* weight_of(const Medium& m) const {
    const auto k = static_cast<std::size_t>(m.stage);
    if (m.stage < 0 || k >= b.weights.size() || !b.weights[k]) return nullptr;
    return b.weights[k] + begin;
  }
};

brume_rays c_rays(const Rays& r) {
  return {static_cast<std::size_t>(r.n), r.ox, r.oy, r.oz, r.dx, r.dy, r.dz};
}

/// What one call needs of a thread: kept from call to call.
struct Work {
  Room room, dense_room;
  std::vector<const float*> weights, dense_weights;
  std::vector<Stretch> at, dense_at;
  std::vector<int> lanes, order;
  std::vector<float> key;
};

// A medium that answers for itself: its own T and L.
void ask_alone(const Medium& m, const Rays& rays, const float* weight, const Stretch& at,
               float* const own[6], float* t0, float* t1) {
  for (int i = 0; i < rays.n; ++i) {
    const bool there = at.lo[i] < at.hi[i];
    t0[i] = there ? at.lo[i] : 0.f;
    t1[i] = !there ? 0.f : at.hi[i] >= kFar ? __builtin_inff() : at.hi[i];
  }
  const brume_rays r = c_rays(rays);
  m.alone(m.self, &r, weight, t0, t1, own, own + 3);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < rays.n; ++i) {
      if (!(at.lo[i] < at.hi[i])) continue;
      at.L[c][i] = own[c][i];
      at.T[c][i] = own[3 + c][i];
    }
}

// The rays that closed forms cannot answer, packed together, through the general rule.
void walk_some(const Air::Impl& air, const Rays& rays, const Part& part,
               const std::vector<const Medium*>& media, Work& w, const float* walks) {
  w.lanes.clear();
  for (int i = 0; i < rays.n; ++i)
    if (walks[i] != 0) w.lanes.push_back(i);
  const int n = int(w.lanes.size()), k = int(media.size());
  const int padded = (n + 15) / 16 * 16;
  const bool shares = !part.b.stage_L.empty();
  w.dense_room.start(std::size_t(8 + k + 3 + (shares ? 3 * k : 0)),
                     air.kernels.walk.scratch_bytes(air.world, k));
  const auto pack = [&](const float* from) -> float* {
    if (!from) return nullptr;
    float* p = w.dense_room.plane();
    for (int i = 0; i < padded; ++i)
      p[i] = from[w.lanes[std::size_t(std::min(i, n - 1))]];
    return p;
  };
  const Rays dense = {padded,        pack(rays.ox),    pack(rays.oy),
                      pack(rays.oz), pack(rays.dx),    pack(rays.dy),
                      pack(rays.dz), pack(rays.begin), pack(rays.end)};
  w.dense_weights.clear();
  for (int j = 0; j < k; ++j) w.dense_weights.push_back(pack(w.weights[std::size_t(j)]));
  float* L[3];
  for (auto& p : L) p = w.dense_room.plane();
  w.dense_at.assign(std::size_t(k), Stretch{});
  if (shares)
    for (auto& s : w.dense_at)
      for (auto& p : s.L) p = w.dense_room.plane();
  air.kernels.walk.walk(air.world, k, media.data(), w.dense_weights.data(), dense, L,
                        shares ? w.dense_at.data() : nullptr, w.dense_room.rest());
  for (int i = 0; i < n; ++i) {
    const int lane = w.lanes[std::size_t(i)];
    for (int c = 0; c < 3; ++c) {
      part.L[c][lane] = L[c][i];
      if (!shares) continue;
      for (std::size_t j = 0; j < std::size_t(k); ++j)
        w.at[j].L[c][lane] = w.dense_at[j].L[c][i];
    }
  }
}

void add_to_stages(const Part& part, const std::vector<const Medium*>& media,
                   const Work& w, int n) {
  const Block& b = part.b;
  for (float* p : b.stage_L) fill(p + part.begin, n, 0.f);
  for (float* p : b.stage_T) fill(p + part.begin, n, 1.f);
  for (std::size_t j = 0; j < media.size(); ++j) {
    const std::size_t plane = 3 * std::size_t(media[j]->stage);
    for (std::size_t c = 0; c < 3; ++c) {
      if (plane + c < b.stage_L.size())
        for (int i = 0; i < n; ++i)
          b.stage_L[plane + c][part.begin + i] += w.at[j].L[c][i];
      if (plane + c < b.stage_T.size())
        for (int i = 0; i < n; ++i)
          b.stage_T[plane + c][part.begin + i] *= w.at[j].T[c][i];
    }
  }
}

// T and L of these media over [begin, end] of the rays.
void together(const Air::Impl& air, const std::vector<const Medium*>& media,
              const Rays& rays, const Part& part) {
  static thread_local Work w;
  const int n = rays.n;
  const bool shares = !part.b.stage_L.empty() || !part.b.stage_T.empty();
  if (media.empty()) {
    for (int c = 0; c < 3; ++c) {
      fill(part.T[c], n, 1.f);
      fill(part.L[c], n, 0.f);
    }
    if (shares) add_to_stages(part, media, w, n);
    return;
  }
  const auto& kernels = air.kernels;
  const Medium& first = *media[0];
  if (media.size() == 1 && first.closed && !first.glows_by_lamp && !first.alone &&
      !shares) {
    const Stretch out = {nullptr,
                         nullptr,
                         {part.T[0], part.T[1], part.T[2]},
                         {part.L[0], part.L[1], part.L[2]}};
    kernels.closed.one(first, air.world, rays, part.weight_of(first), out, false);
    return;
  }
  // Each medium by itself.
  const std::size_t k = media.size();
  w.room.start(8 * k + 9, kernels.lamps.scratch_bytes(int(k)));
  w.at.clear();
  w.weights.clear();
  float* own[6];
  for (auto& p : own) p = w.room.plane();
  float *t0 = w.room.plane(), *t1 = w.room.plane(), *walks = w.room.plane();
  bool lamps = false;
  for (std::size_t j = 0; j < k; ++j) {
    const Medium& m = *media[j];
    Stretch s;
    s.lo = w.room.plane();
    s.hi = w.room.plane();
    for (int c = 0; c < 3; ++c) {
      s.T[c] = w.room.plane();
      s.L[c] = w.room.plane();
    }
    w.weights.push_back(part.weight_of(m));
    kernels.closed.one(m, air.world, rays, w.weights.back(), s, !air.indifferent);
    if (m.alone) ask_alone(m, rays, w.weights.back(), s, own, t0, t1);
    w.at.push_back(s);
    lamps = lamps || m.glows_by_lamp;
  }
  w.order.resize(k);
  w.key.resize(k);
  const Layers layers = {int(k),         media.data(), w.at.data(),
                         w.order.data(), w.key.data(), shares};
  if (kernels.compose.compose(layers, n, part.T, part.L, walks))
    walk_some(air, rays, part, media, w, walks);
  if (lamps)
    kernels.lamps.add(air.world, int(k), media.data(), w.weights.data(), rays, part.L,
                      part.b.stage_L.empty() ? nullptr : w.at.data(), w.room.rest());
  if (shares) add_to_stages(part, media, w, n);
}

// Fewer rays meet fewer media: a block is halved while that leaves some out on either
// side.
constexpr int kFewest = 32;  // rays
constexpr int kMany = 2;     // media that are not worth it

Rays part_of(const Rays& r, int begin, int n) {
  Rays part = r;
  part.n = n;
  for (const float** p : {&part.ox, &part.oy, &part.oz, &part.dx, &part.dy, &part.dz,
                          &part.begin, &part.end})
    if (*p) *p += begin;
  return part;
}

void divide(const Air::Impl& air, const Candidates& of, const Rays& rays, const Block& b,
            int begin, int depth) {
  // Two halves at each depth.
  static thread_local Candidates halves[8][2];
  if (of.size() <= kMany || rays.n <= kFewest || rays.ox)
    return together(air, of.media(), rays, Part{b, begin});
  const int half = (rays.n / 2 + 15) / 16 * 16;
  const Rays part[2] = {part_of(rays, 0, half), part_of(rays, half, rays.n - half)};
  Candidates* of_half = halves[depth];
  for (int i = 0; i < 2; ++i)
    of_half[i].choose(of, cone_around(part[i], air.kernels.cone), air.kernels.cone);
  if (of_half[0].size() + of_half[1].size() > 2 * of.size() - 2)
    return together(air, of.media(), rays, Part{b, begin});
  for (int i = 0; i < 2; ++i)
    divide(air, of_half[i], part[i], b, begin + i * half, depth + 1);
}

// The media that a block of rays may meet.
const Candidates& chosen(const Air::Impl& air, const Rays& rays) {
  static thread_local Candidates some;
  if (!air.bounded) return air.anywhere;
  some.choose(air.anywhere, cone_around(rays, air.kernels.cone), air.kernels.cone);
  return some;
}

void segment(const Air::Impl& air, const Rays& rays, const Block& b) {
  const Candidates& some = chosen(air, rays);
  air.bounded ? divide(air, some, rays, b, 0, 0)
              : together(air, some.media(), rays, Part{b});
}

}  // namespace

void integrate_block(const Air::Impl& air, const Block& b) {
  if (air.interfaces.empty()) return segment(air, b.rays, b);
  split_at_interfaces(air, b);
}

void segment_block(const Air::Impl& air, const Rays& rays, const Block& b) {
  segment(air, rays, b);
}

void transmittance_block(const Air::Impl& air, const Block& b) {
  static thread_local Work w;
  const int n = b.rays.n;
  constexpr std::size_t kPlanes = 3 + 4 + 3 + 6;
  w.room.start(kPlanes, 0);
  Stretch s;
  for (auto& p : s.T) p = w.room.plane();
  // For those that answer for themselves.
  Stretch told = s;
  told.lo = w.room.plane(), told.hi = w.room.plane();
  float *t0 = w.room.plane(), *t1 = w.room.plane();
  for (auto& p : told.L) p = w.room.plane();
  float* own[6];
  for (auto& p : own) p = w.room.plane();
  for (float* p : b.T) fill(p, n, 1.f);
  for (const Medium* m : chosen(air, b.rays).media()) {
    const float* weight = Part{b}.weight_of(*m);
    air.kernels.closed.one(*m, air.world, b.rays, weight, m->alone ? told : s, true);
    if (m->alone) ask_alone(*m, b.rays, weight, told, own, t0, t1);
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < n; ++i) b.T[c][i] *= s.T[c][i];
  }
}

}  // namespace brume::air
