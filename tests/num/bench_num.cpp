// bench_num: nanoseconds per value of every function of num/math.h, per instruction set,
// in cache, one thread; the least of many passes. Not a test.
//   bench_num            a table
//   bench_num --comments the lines for the comments of num/math_*.h

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <limits>

#include "functions.h"

using namespace brume;
using namespace brume::test;

static double nanoseconds(const Function& f) {
  constexpr int n = 1024;
  static float x[4][n], out[n];
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < n; ++i)
      x[k][i] = 0.01f + static_cast<float>((i * (7 + 2 * k)) % n) * 0.00097f;
  const float* in[4] = {x[0], x[1], x[2], x[3]};
  double best = std::numeric_limits<double>::max();
  for (int pass = 0; pass < 60; ++pass) {
    const auto start = std::chrono::steady_clock::now();
    constexpr int repeats = 20;
    for (int r = 0; r < repeats; ++r) {
      f.batch(in, out, n);
      __asm__ volatile("" ::"r"(out) : "memory");
    }
    const std::chrono::duration<double, std::nano> t =
        std::chrono::steady_clock::now() - start;
    best = std::min(best, t.count() / (n * repeats));
  }
  return best;
}

int main(int argc, char** argv) {
  const bool comments = argc > 1 && !std::strcmp(argv[1], "--comments");
  const Isa best = best_isa();
  if (!comments) std::printf("%-24s %8s %8s %8s   ns per value\n", "", "v4", "v3", "v2");
  for (int i = 0; i < isa_v2::functions.size; ++i) {
    const double v2 = nanoseconds(isa_v2::functions.begin[i]);
    const double v3 = best >= Isa::v3 ? nanoseconds(isa_v3::functions.begin[i]) : 0;
    const double v4 = best >= Isa::v4 ? nanoseconds(isa_v4::functions.begin[i]) : 0;
    std::printf(comments ? "//   Cost [%s]: v4 %.2g, v3 %.2g, v2 %.2g ns\n"
                         : "%-24s %8.3f %8.3f %8.3f\n",
                isa_v2::functions.begin[i].name, v4, v3, v2);
  }
}
