#include "stress/patience.h"

#include <algorithm>

namespace brume::stress {

// A medium's function, asked by whoever holds the one in between.
template <class... A, void (*brume_medium::*function)(const void*, A...)>
struct Patience::Through<function> {
  static void call(const void* self, A... a) {
    const brume_medium& m = static_cast<const Medium*>(self)->what;
    (m.*function)(m.self, a...);
  }
  static void put(brume_medium& m) {
    if (m.*function) m.*function = call;
  }
};

bool Patience::over() {
  if (!lost() && Clock::now() > until_) lost_ = true;
  return lost();
}

void Patience::integral(const void* self, const brume_rays* rays, const float* t0,
                        const float* t1, float* D) {
  const Medium& m = *static_cast<const Medium*>(self);
  if (m.patience.over())
    std::fill_n(D, rays->n, 0.f);
  else
    m.what.integral(m.what.self, rays, t0, t1, D);
}

Patience::Patience(World& world, Clock::time_point until) : until_(until) {
  for (auto& published : world.media) {
    brume_medium& m = published.what;
    if (!m.integral) continue;
    media_.push_back({m, *this});
    Through<&brume_medium::density>::put(m);
    Through<&brume_medium::source_at>::put(m);
    Through<&brume_medium::alone>::put(m);
    Through<&brume_medium::point>::put(m);
    Through<&brume_medium::tint>::put(m);
    Through<&brume_medium::spectral_point>::put(m);
    m.integral = integral;
    m.self = &media_.back();
  }
}

}  // namespace brume::stress
