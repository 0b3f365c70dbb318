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

  // Runs `f` on a group, and counts what became of it.
  template <class F>
  void on(const Maker& maker, const Options& o, std::uint64_t number, bool count, F&& f) {
    Findings mine;
    try {
      auto g = make_group(maker, o, number);
      if (g) f(*g, mine);
      const std::lock_guard lock(mutex);
      found.add(mine);
      if (!count) return;
      g ? report.cases += kGroup : ++report.idle;
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
  if (o.only) {
    total.on(maker, o, *o.only / kGroup, true, [&](Group& g, Findings& found) {
      check_laws(g, o, found);
      total.count(check_truth(g, o, int(*o.only % kGroup), found));
    });
  } else {
    // Batches, so that the clock is seen between them.
    constexpr std::uint64_t kBatch = 16, kTruths = 8;
    const auto batches = [&](std::uint64_t end, double until, auto&& work) {
      for (std::uint64_t at = 0; at < end && since(begin) < until; at += kBatch)
        tbb::parallel_for(at, std::min(at + kBatch, end), work);
    };
    std::uint64_t groups = 0;
    while (total.report.cases < o.cases && since(begin) < 0.75 * o.seconds) {
      tbb::parallel_for(groups, groups + kBatch, [&](std::uint64_t n) {
        total.on(maker, o, n, true,
                 [&](Group& g, Findings& found) { check_laws(g, o, found); });
      });
      groups += kBatch;
      if (groups * kGroup > 64 * o.cases) break;  // idle whatever it is given
    }
    const double truths_until = since(begin) + 0.25 * o.seconds;
    batches(groups, truths_until, [&](std::uint64_t n) {
      total.on(maker, o, n, false, [&](Group& g, Findings& found) {
        for (std::uint64_t k = 0; k < kTruths && since(begin) < truths_until; ++k)
          total.count(check_truth(g, o, int((7 * n + 37 * k) % kGroup), found));
      });
    });
  }
  total.report.stage = stage;
  total.report.seed = o.seed;
  total.report.findings = total.found.of;
  total.report.seconds = since(begin);
  return total.report;
}

std::string describe(const Maker& maker, const Options& o, std::uint64_t number) {
  const auto g = make_group(maker, o, number / kGroup);
  if (!g) return "(nothing to do)\n";
  const int i = int(number % kGroup);
  const glm::dvec3 e = g->frame.eye, u = g->frame.up, p = e + g->rays.origin(i),
                   d = g->rays.direction(i);
  const auto vec = [](const glm::dvec3& v) {
    return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
  };
  const Answers a = ask(g->air(), g->rays, i, 1);
  return g->subject.text + fmt::format(
                               "# eye {}, up {}\n# ray from {} along {}, {} m{}\n"
                               "# T {} {} {}, L {} {} {}\n",
                               vec(e), vec(u), vec(p), vec(d), g->rays.t[std::size_t(i)],
                               g->world().lights.empty() ? "" : ", lights", a.T[0][0],
                               a.T[1][0], a.T[2][0], a.L[0][0], a.L[1][0], a.L[2][0]);
}

}  // namespace brume::stress
