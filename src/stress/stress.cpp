#include "stress/stress.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>

#include "num/error.h"
#include "stress/draw.h"
#include "stress/laws.h"

namespace brume::stress {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct About {
  const char *name, *meaning;
};
constexpr About kAbout[kLaws] = {
    {"finite", "T and L are numbers"},
    {"range", "0 <= T <= 1"},
    {"positive", "L >= 0"},
    {"energy", "L <= source (1 - T)"},
    {"split", "T(a,c) = T(a,b) T(b,c)"},
    {"split_L", "L(a,c) = L(a,b) + T(a,b) L(b,c)"},
    {"monotone", "farther is never clearer"},
    {"scale", "lengths x k, densities / k"},
    {"weight", "weight w gives T^w"},
    {"lanes", "any n, any address: same bits"},
    {"neighbours", "NaN stays where it is"},
    {"isa", "instruction sets agree"},
    {"truth_T", "T as the truth has it"},
    {"truth_L", "L as the truth has it"},
};

// What groups have found so far; several threads add to it.
struct Total {
  std::mutex mutex;
  Findings found;
  Report report;

  void count(Verdict v) {
    const std::lock_guard lock(mutex);
    report.truths += v == Verdict::given;
    report.undecided += v == Verdict::undecided;
  }

  bool enough(const Options& o, bool count) {
    const std::lock_guard lock(mutex);
    return count && report.cases >= o.cases;
  }

  // Runs `f` on the groups [begin, end) of one world, and counts what became of them. It
  // says whether it has done them: there is time.
  template <class F>
  void on(const Maker& maker, const Options& o, std::uint64_t share, std::uint64_t begin,
          std::uint64_t end, bool count, F&& f) {
    try {
      const auto setting = make_setting(maker, o, begin / share);
      for (std::uint64_t number = begin; setting && number < end; ++number) {
        if (share > 1 && enough(o, count)) break;
        Findings mine;
        Group g = make_group(*setting, o, share, number);
        if (!f(g, mine)) break;
        const std::lock_guard lock(mutex);
        found.add(mine);
        if (count) report.cases += kGroup;
      }
      const std::lock_guard lock(mutex);
      report.idle += count && !setting;
    } catch (const Error& e) {
      const std::lock_guard lock(mutex);
      if (!count) return;
      if (report.refused++ == 0) report.refusal = e.what();
    }
  }
};

// Parameters that may not change over a sequence often stand for a table that costs
// seconds: few values of them are tried, the defaults mostly.
constexpr int kTables = 4;

}  // namespace

const char* name(Law law) { return kAbout[std::size_t(law)].name; }
const char* meaning(Law law) { return kAbout[std::size_t(law)].meaning; }

bool Report::ok() const {
  return std::all_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return f.broken == 0; });
}

Maker maker_of(const StageType& type, StageCache& cache) {
  return [&type, &cache](Random& r, const FrameInfo& frame) -> std::optional<Subject> {
    const int table = integer(r, 16) == 0 ? 1 + integer(r, kTables - 1) : 0;
    Random of_table(0x7ab1e, std::uint64_t(table));
    Settings settings = Settings::defaults(type.specs);
    std::string text;
    for (std::size_t i = 0; i < type.specs.size(); ++i) {
      const ParamSpec& spec = type.specs[i];
      if (!spec.animatable && table == 0) continue;
      if (spec.knob) continue;  // it follows the tolerance that the laws go by
      const Value value = draw_value(spec, spec.animatable ? r : of_table);
      settings.values[i].keys = {{0, value}};
      if (value != default_value(spec))
        text += fmt::format("{} = {}\n", spec.name, print(spec, value));
    }
    auto instance =
        std::make_shared<StageInstance>(type, type.name, settings.at(0), cache);
    if (!instance->needs(frame).idle.empty()) return {};
    Subject s;
    s.world.eye = frame.eye;
    s.world.up = frame.up;
    instance->publish(frame, 0, s.world);
    s.keep = instance;
    s.text = text;
    return s;
  };
}

Report run(const std::string& stage, const Maker& maker, const Options& o) {
  const auto begin = Clock::now();
  Total total;
  const std::uint64_t share = groups_per_world(maker, o);
  if (o.only) {
    const std::uint64_t n = *o.only / kGroup;
    total.on(maker, o, share, n, n + 1, true, [&](Group& g, Findings& found) {
      check_laws(g, o, found);
      total.count(check_truth(g, o, int(*o.only % kGroup), found));
      return true;
    });
  } else {
    // Batches of worlds, so that the clock is seen between them.
    constexpr std::uint64_t kTruths = 8;
    const std::uint64_t batch_size = share > 1 ? 2 : 16;
    const auto batch = [&](std::uint64_t world, bool count, auto&& f) {
      tbb::parallel_for(world, world + batch_size, [&](std::uint64_t w) {
        total.on(maker, o, share, w * share, (w + 1) * share, count, f);
      });
    };
    std::uint64_t worlds = 0;
    const double laws_until = 0.75 * o.seconds;
    while (total.report.cases < o.cases && since(begin) < laws_until) {
      batch(worlds, true, [&](Group& g, Findings& found) {
        if (since(begin) >= laws_until) return false;
        check_laws(g, o, found);
        return true;
      });
      worlds += batch_size;
      if (worlds * share * kGroup > 64 * o.cases) break;  // idle whatever it is given
    }
    const double truths_until = since(begin) + 0.25 * o.seconds;
    for (std::uint64_t w = 0; w < worlds && since(begin) < truths_until; w += batch_size)
      batch(w, false, [&](Group& g, Findings& found) {
        for (std::uint64_t k = 0; k < kTruths && since(begin) < truths_until; ++k)
          total.count(check_truth(g, o, int((7 * g.number + 37 * k) % kGroup), found));
        return since(begin) < truths_until;
      });
  }
  total.report.stage = stage;
  total.report.seed = o.seed;
  total.report.findings = total.found.of;
  total.report.seconds = since(begin);
  return total.report;
}

std::string describe(const Maker& maker, const Options& o, std::uint64_t number) {
  const std::uint64_t share = groups_per_world(maker, o), n = number / kGroup;
  const auto setting = make_setting(maker, o, n / share);
  if (!setting) return "(nothing to do)\n";
  const Group g = make_group(*setting, o, share, n);
  const int i = int(number % kGroup);
  const auto k = std::size_t(i);
  const glm::dvec3 e = g.frame.eye, u = g.frame.up, p = e + g.rays.origin(i),
                   d = g.rays.direction(i);
  const auto vec = [](const glm::dvec3& v) {
    return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
  };
  const Answers a = ask(g.air(), g.rays, {i, 1});
  return g.subject.text + fmt::format(
                              "# eye {}, up {}\n# ray from {} along {}, {} m{}\n"
                              "# T {} {} {}, L {} {} {}\n",
                              vec(e), vec(u), vec(p), vec(d), g.rays.t[std::size_t(i)],
                              g.world().lights.empty() ? "" : ", lights", a.T[0][k],
                              a.T[1][k], a.T[2][k], a.L[0][k], a.L[1][k], a.L[2][k]);
}

}  // namespace brume::stress
