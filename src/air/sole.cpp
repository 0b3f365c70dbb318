#include "air/impl.h"

namespace brume {

std::optional<SoleMedium> Air::sole() const {
  const Impl& air = *impl_;
  if (air.media.size() != 1 || !air.interfaces.empty() || !air.backgrounds.empty())
    return {};
  const air::Medium& m = air.media[0];
  const bool plain = m.shape == BRUME_EVERYWHERE && m.start == 0 && m.cap == 0 &&
                     m.closed && m.grey && !m.emits && !m.glows_by_sun &&
                     !m.glows_by_lamp && !m.alone;
  if (!plain || (m.profile != BRUME_UNIFORM && m.profile != BRUME_EXPONENTIAL)) return {};
  SoleMedium s;
  s.sigma = m.sigma[0];
  s.rho0 = 1;
  if (m.profile == BRUME_EXPONENTIAL) {
    s.log_rho0 = m.log_rho0;
    s.rho0 = m.rho0;
    for (int k = 0; k < 3; ++k) s.grad[k] = m.grad[k];
  }
  for (int c = 0; c < 3; ++c) s.color[c] = m.S[c];
  return s;
}

}  // namespace brume
