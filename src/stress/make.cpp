// Stages under test, made through the product's own path.

#include <fmt/format.h>

#include <algorithm>

#include "stress/draw.h"
#include "stress/isas.h"
#include "stress/stress.h"

namespace brume::stress {
namespace {

// Parameters that may not change over a sequence often stand for a table that costs
// seconds: few values of them are tried, the defaults mostly.
constexpr int kTables = 4;

}  // namespace

Maker maker_of(const StageType& type, StageCache& cache, const LowerIsas* lower) {
  return [&type, &cache, lower](Random& r,
                                const FrameInfo& frame) -> std::optional<Subject> {
    const int table = integer(r, 16) == 0 ? 1 + integer(r, kTables - 1) : 0;
    Random of_table(0x7ab1e, std::uint64_t(table));
    Settings settings = Settings::defaults(type.specs);
    Draw draw(r, frame), draw_table(of_table, frame);
    Subject s;
    s.role = type.role;
    s.step = type.step;
    for (std::size_t i = 0; i < type.specs.size(); ++i) {
      const ParamSpec& spec = type.specs[i];
      if (!spec.animatable && table == 0) continue;
      if (spec.knob) continue;  // it follows the tolerance that the laws go by
      const Value value = (spec.animatable ? draw : draw_table).value(spec);
      settings.values[i].keys = {{0, value}};
      if (value != default_value(spec))
        s.text += fmt::format("{} = {}\n", spec.name, print(spec, value));
    }
    const auto make = [&type, &cache, values = settings.at(0)] {
      return std::make_shared<StageInstance>(type, type.name, values, cache);
    };
    const std::shared_ptr<StageInstance> instance = make();
    if (!instance->needs(frame).idle.empty()) return {};
    s.keep = instance;
    if (s.role == BRUME_AIR) {
      s.world.eye = frame.eye;
      s.world.up = frame.up;
      instance->publish(frame, 0, s.world);
      return s;
    }
    s.at = [make, lower, values = settings.at(0),
            has_truth = type.table.truth != nullptr](const FrameInfo& f) {
      const std::shared_ptr<StageInstance> stage = make();
      PixelStage p;
      p.needs = stage->needs(f);
      stage->publish(f, 0, p.world);
      p.run = [stage](const brume_tile& tile) { stage->run(tile); };
      if (has_truth)
        p.truth = [stage](const brume_tile& tile, std::span<const int> xy, double* rgb) {
          stage->truth(tile, xy, rgb);
        };
      if (lower)
        for (const LowerIsas::One& one : lower->all())
          p.lower.push_back({one.isa, [&one, values, f](const brume_tile& tile) {
                               StageInstance there(*one.type, one.type->name, values,
                                                   *one.cache);
                               there.needs(f);
                               World w;
                               there.publish(f, 0, w);
                               there.run(tile);
                             }});
      return p;
    };
    return s;
  };
}

}  // namespace brume::stress
