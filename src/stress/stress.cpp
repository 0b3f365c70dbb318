#include "stress/stress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "num/error.h"
#include "stress/group.h"

namespace brume::stress {
namespace {

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// What became of one group.
struct Done {
  std::uint64_t number = 0, cases = 0, truths = 0, undecided = 0;
  bool given_up = false;
  Findings found;

  void count(Verdict v) {
    truths += v == Verdict::given;
    undecided += v == Verdict::undecided;
  }
};

// And of the groups of one world.
struct Worked {
  std::vector<Done> groups;
  bool idle = false;
  std::optional<std::string> refusal;
};

Clock::time_point after(Clock::time_point begin, double seconds) {
  return begin + std::chrono::duration_cast<Clock::duration>(
                     std::chrono::duration<double>(std::min(seconds, 1e9)));
}

// Runs `f` on the groups [begin, end) of one world until it says that there is no more
// time, or there are `most` cases. What a group may take ends by `until`.
template <class F>
Worked work(const Maker& maker, const Options& o, std::uint64_t share,
            std::uint64_t begin, std::uint64_t end, std::uint64_t most,
            Clock::time_point until, F&& f) {
  Worked world;
  try {
    const auto setting = make_setting(maker, o, begin / share);
    world.idle = !setting;
    std::uint64_t cases = 0;
    for (std::uint64_t n = begin; setting && n < end && cases < most; ++n) {
      Done done;
      done.number = n;
      const double share_of_time = o.only ? 1 : o.most_of_time;
      const auto g =
          make_group(*setting, o, share, n,
                     std::min(until, after(Clock::now(), share_of_time * o.seconds)));
      done.cases = std::uint64_t(g->size());
      if (!f(*g, done)) break;
      if (g->given_up()) {
        if (Clock::now() >= until && !o.only) break;
        done = Done();
        done.number = n;
        done.given_up = true;
      }
      cases += done.cases;
      world.groups.push_back(std::move(done));
    }
  } catch (const Error& e) {
    world.refusal = e.what();
  }
  return world;
}

// Worlds counted one after the other, whatever the order they were done in: what is found
// depends on seed and number of cases alone, as long as time does not end it.
struct Total {
  Findings found;
  Report report;
  std::uint64_t end = 0;  ///< groups below it count
  std::set<std::uint64_t> given_up = {};

  void take_laws(const Worked& world, std::uint64_t most) {
    if (report.cases >= most) return;
    report.idle += world.idle;
    if (world.refusal && report.refused++ == 0) report.refusal = *world.refusal;
    for (const Done& done : world.groups) {
      if (report.cases >= most) return;
      report.cases += done.cases;
      end = done.number + 1;
      take(done);
    }
  }
  void take(const Done& done) {
    if (done.given_up) given_up.insert(done.number);
    found.add(done.found);
    report.truths += done.truths;
    report.undecided += done.undecided;
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
    const auto all = [&](Group& g, Done& done) {
      g.check_laws(done.found);
      if (const int i = int(*o.only % kGroup); i < g.size())
        done.count(g.check_truth(i, done.found));
      return true;
    };
    total.take_laws(work(maker, o, share, n, n + 1, kGroup, after(begin, o.seconds), all),
                    kGroup);
  } else {
    // Batches of worlds, so that cases are counted between them; many, as all wait for
    // the dearest world of a batch.
    constexpr std::uint64_t kTruths = 8;
    const std::uint64_t batch_size =
        share > 1 ? 2 : std::clamp<std::uint64_t>(o.cases / kGroup / 16, 16, 256);
    std::vector<Worked> batch(batch_size);
    const auto each_world = [&](std::uint64_t first, std::uint64_t end,
                                std::uint64_t most, Clock::time_point until, auto&& f) {
      tbb::parallel_for(std::uint64_t{0}, batch_size, [&](std::uint64_t k) {
        const std::uint64_t from = (first + k) * share, to = std::min(from + share, end);
        batch[k] = from < to ? work(maker, o, share, from, to, most, until, f) : Worked{};
      });
    };
    std::uint64_t worlds = 0;
    const auto laws_until = after(begin, 0.75 * o.seconds);
    while (total.report.cases < o.cases && Clock::now() < laws_until) {
      each_world(worlds, ~std::uint64_t{0}, o.cases - total.report.cases, laws_until,
                 [&](Group& g, Done& done) {
                   if (Clock::now() >= laws_until) return false;
                   g.check_laws(done.found);
                   return true;
                 });
      for (const Worked& world : batch) total.take_laws(world, o.cases);
      worlds += batch_size;
      if (worlds * share * kGroup > 64 * o.cases) break;  // idle whatever it is given
    }
    const auto truths_until = after(Clock::now(), 0.25 * o.seconds);
    for (std::uint64_t w = 0; w * share < total.end && Clock::now() < truths_until;
         w += batch_size) {
      each_world(
          w, total.end, ~std::uint64_t{0}, truths_until, [&](Group& g, Done& done) {
            if (total.given_up.contains(g.number)) return true;
            if (Clock::now() >= truths_until) return false;
            for (std::uint64_t k = 0; k < kTruths && Clock::now() < truths_until; ++k) {
              const auto i = (7 * g.number + 37 * k) % std::uint64_t(g.size());
              done.count(g.check_truth(int(i), done.found));
            }
            return true;
          });
      for (const Worked& world : batch)
        for (const Done& done : world.groups) total.take(done);
    }
  }
  total.report.stage = stage;
  total.report.seed = o.seed;
  total.report.findings = total.found.of;
  total.report.given_up = total.given_up.size();
  if (!total.given_up.empty())
    total.report.first_given_up = *total.given_up.begin() * kGroup;
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
