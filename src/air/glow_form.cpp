#include "air/glow_form.h"

#include <algorithm>
#include <cmath>

namespace brume::air {
namespace {

bool around(const Medium& m, const float x[3]) {
  if (m.shape == BRUME_EVERYWHERE) return true;
  double local[3];
  for (int i = 0; i < 3; ++i) {
    local[i] = m.b[i];
    for (int c = 0; c < 3; ++c) local[i] += double(m.A[3 * i + c]) * x[c];
  }
  if (m.shape == BRUME_HALF_SPACE) return local[2] <= 0;
  if (m.shape == BRUME_BOX)
    return std::max({std::abs(local[0]), std::abs(local[1]), std::abs(local[2])}) <= 1;
  return std::hypot(local[0], local[1], local[2]) <= 1;
}

}  // namespace

bool glow_is_closed(const Air::Impl& air, const Light& lamp) {
  if (lamp.kind != BRUME_POINT) return false;
  if (lamp.attenuated && !air.shadowers.empty()) return false;
  return std::all_of(air.media.begin(), air.media.end(), [&](const Medium& m) {
    if (!m.absorbs) return true;
    const bool even = m.phase == BRUME_HENYEY_GREENSTEIN && m.g == 0;
    return m.profile == BRUME_UNIFORM && m.start == 0 && m.cap == 0 &&
           (even || !m.glows_by_lamp) && (!lamp.attenuated || around(m, lamp.position));
  });
}

}  // namespace brume::air
