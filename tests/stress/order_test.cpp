// What is counted, whatever the number of threads.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <chrono>
#include <thread>

#include "num/error.h"
#include "stress/stress.h"

namespace brume::stress {
namespace {

TEST(Stress, FindsTheSameInAnyNumberOfThreads) {
  // Frames of 1 to 128 pixels, so that no number of cases is a whole number of groups,
  // from worlds that take any time; some are idle, some refuse.
  for (const brume_role role : {BRUME_LENS, BRUME_SURFACE}) {
    const Maker maker = [&](Random& r, const FrameInfo&) -> std::optional<Subject> {
      const double dice = r.uniform();
      if (dice < 0.1) return {};
      if (dice < 0.2) throw Error("toy", "refused");
      std::this_thread::sleep_for(std::chrono::duration<double>(1e-3 * r.uniform()));
      Subject s;
      s.role = role;
      s.step = BRUME_LIGHT_STEP;
      s.at = [dim = float(dice)](const FrameInfo&) {
        PixelStage p;
        p.run = [dim](const brume_tile& t) { t.r[0] *= dim; };
        return p;
      };
      return s;
    };
    const Options o{.cases = 20000, .seed = 5, .seconds = 600};
    const auto in = [&](std::size_t threads) {
      const tbb::global_control most(tbb::global_control::max_allowed_parallelism,
                                     threads);
      return run("test", maker, o);
    };
    const Report one = in(1);
    EXPECT_GE(one.cases, o.cases);
    EXPECT_LT(one.cases, o.cases + kGroup);
    if (role == BRUME_SURFACE) {  // those of a lens share few worlds
      EXPECT_GT(one.idle, 0u);
      EXPECT_GT(one.refused, 0u);
    }
    for (int again = 0; again < 3; ++again) {
      const Report many = in(8);
      EXPECT_EQ(many.cases, one.cases);
      EXPECT_EQ(many.idle, one.idle);
      EXPECT_EQ(many.refused, one.refused);
      for (std::size_t k = 0; k < one.findings.size(); ++k) {
        EXPECT_EQ(many.findings[k].checked, one.findings[k].checked) << name(Law(k));
        EXPECT_EQ(many.findings[k].broken, one.findings[k].broken) << name(Law(k));
        EXPECT_EQ(many.findings[k].worst_case, one.findings[k].worst_case)
            << name(Law(k));
      }
    }
  }
}

}  // namespace
}  // namespace brume::stress
