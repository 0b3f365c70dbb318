#include "stress/group.h"

#include <algorithm>

#include "num/error.h"
#include "stress/draw.h"

namespace brume::stress {

std::optional<Setting> make_setting(const Maker& maker, const Options& options,
                                    std::uint64_t number) {
  Setting s;
  s.number = number;
  s.random = Random(options.seed, number);
  s.frame = draw_frame(s.random);
  s.frame.tolerance = options.tolerance;
  s.frame.white = options.white;
  auto subject = maker(s.random, s.frame);
  if (!subject) return {};
  s.subject = std::move(*subject);
  return s;
}

std::uint64_t groups_per_setting(const Maker& maker, const Options& options) {
  for (std::uint64_t number = 0; number < 64; ++number) {
    std::optional<Setting> s;
    try {
      s = make_setting(maker, options, number);
    } catch (const Error&) {
      continue;
    }
    if (!s) continue;
    const auto& media = s->subject.world.media;
    const bool sky =
        std::any_of(media.begin(), media.end(), [](auto& m) { return m.what.is_sky; });
    return sky || s->subject.role == BRUME_LENS ? 64 : 1;
  }
  return 1;
}

std::unique_ptr<Group> make_group(const Setting& setting, const Options& options,
                                  std::uint64_t share, std::uint64_t number,
                                  Clock::time_point until) {
  const Random random = share == 1 ? setting.random : Random(~options.seed, number);
  if (setting.subject.role == BRUME_AIR)
    return make_air_group(setting, options, number, random, until);
  const auto make =
      setting.subject.role == BRUME_SURFACE ? make_surface_group : make_lens_group;
  return make(setting, options, number, random);
}

}  // namespace brume::stress
