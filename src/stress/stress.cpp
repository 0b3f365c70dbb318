#include "stress/stress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>

#include "num/error.h"
#include "stress/group.h"

namespace brume::stress {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

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
        const std::unique_ptr<Group> g = make_group(*setting, o, share, number);
        if (!f(*g, mine)) break;
        const std::lock_guard lock(mutex);
        found.add(mine);
        if (count) report.cases += std::uint64_t(g->size());
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

}  // namespace

bool Report::ok() const {
  return std::all_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return f.broken == 0; });
}

Report run(const std::string& stage, const Maker& maker, const Options& o) {
  const auto begin = Clock::now();
  Total total;
  const std::uint64_t share = groups_per_setting(maker, o);
  if (o.only) {
    const std::uint64_t n = *o.only / kGroup;
    total.on(maker, o, share, n, n + 1, true, [&](Group& g, Findings& found) {
      g.check_laws(found);
      if (const int i = int(*o.only % kGroup); i < g.size())
        total.count(g.check_truth(i, found));
      return true;
    });
  } else {
    // Batches of worlds, so that cases are counted between them; many, as all wait for
    // the dearest world of a batch.
    constexpr std::uint64_t kTruths = 8;
    const std::uint64_t batch_size =
        share > 1 ? 2 : std::clamp<std::uint64_t>(o.cases / kGroup / 16, 16, 256);
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
        g.check_laws(found);
        return true;
      });
      worlds += batch_size;
      if (worlds * share * kGroup > 64 * o.cases) break;  // idle whatever it is given
    }
    const double truths_until = since(begin) + 0.25 * o.seconds;
    for (std::uint64_t w = 0; w < worlds && since(begin) < truths_until; w += batch_size)
      batch(w, false, [&](Group& g, Findings& found) {
        for (std::uint64_t k = 0; k < kTruths && since(begin) < truths_until; ++k)
          total.count(g.check_truth(
              int((7 * g.number + 37 * k) % std::uint64_t(g.size())), found));
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
  const std::uint64_t share = groups_per_setting(maker, o), n = number / kGroup;
  const auto setting = make_setting(maker, o, n / share);
  if (!setting) return "(nothing to do)\n";
  const std::unique_ptr<Group> g = make_group(*setting, o, share, n);
  const int i = int(number % kGroup);
  return setting->subject.text + (i < g->size() ? g->describe(i) : "(no such case)\n");
}

}  // namespace brume::stress
