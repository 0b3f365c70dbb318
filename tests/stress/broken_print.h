#pragma once
// What tests of broken stages print: how often each law found them out.

#include <cstdio>

#include "stress/stress.h"

namespace brume::stress {

inline void print(const Report& r) {
  std::printf("%llu cases, %llu truths:", (unsigned long long)r.cases,
              (unsigned long long)r.truths);
  for (int k = 0; k < kLaws; ++k)
    if (r.of(Law(k)).broken > 0)
      std::printf(" %s %llu (case %llu)", name(Law(k)),
                  (unsigned long long)r.of(Law(k)).broken,
                  (unsigned long long)r.of(Law(k)).worst_case);
  std::printf("\n");
}

}  // namespace brume::stress
