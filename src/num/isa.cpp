#include "num/isa.h"

#include <cstdlib>
#include <string>

#include "num/error.h"

namespace brume {

// By features rather than by level, whose names clang 14 does not know; those of each
// level that kernels are compiled to use (System V psABI for x86-64, table 3.1).
Isa best_isa() {
  __builtin_cpu_init();
  const bool v2 = __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
  const bool v3 = v2 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  const bool v4 =
      v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl");
  if (v4) return Isa::v4;
  if (v3) return Isa::v3;
  if (v2) return Isa::v2;
  throw Error("processor", "lacks x86-64-v2 (SSE4.2)",
              "brume runs on processors from about 2009 on");
}

Isa isa_from(std::string_view text) {
  const Isa best = best_isa();
  for (const Isa isa : {Isa::v2, Isa::v3, Isa::v4}) {
    if (text != name(isa)) continue;
    if (isa <= best) return isa;
    throw Error("BRUME_ISA", "this processor has no " + std::string(text),
                std::string("its best is ") + name(best));
  }
  throw Error("BRUME_ISA", "unknown value '" + std::string(text) + "'",
              "allowed: v2, v3, v4");
}

Isa isa() {
  static const Isa chosen = [] {
    const char* forced = std::getenv("BRUME_ISA");
    return forced ? isa_from(forced) : best_isa();
  }();
  return chosen;
}

const char* name(Isa isa) noexcept {
  return isa == Isa::v4 ? "v4" : isa == Isa::v3 ? "v3" : "v2";
}

}  // namespace brume
