#pragma once
// One binary, three instruction sets. A kernel file is compiled once for each of
// x86-64-v2, v3 and v4 (brume_isa_sources in src/brume.cmake defines BRUME_ISA); at run
// time the best one is chosen, once.
//
// Everything of ours that a kernel file instantiates lives in an inline namespace named
// after the instruction set: brume::isa_v3::exp<float> and brume::isa_v4::exp<float> are
// different symbols, and the linker never takes one processor's code for another's.
// Elsewhere (scalar code, tests) that namespace is isa_host; there templates work with
// T = float, double, and a Batch of the baseline's width.
//
// The pattern, in three places (kernel files hold kernels only: nothing that allocates,
// throws, or is an inline function of std::):
//
// rows.h, included by both:
//   namespace brume::air {
//   struct RowKernels { void (*fog)(const float* z, float* t, int n) noexcept; };
//   BRUME_ISA_DECLARE(RowKernels, row_kernels)
//   }
//
// rows.cpp, listed under ISA in its CMakeLists.txt:
//   namespace brume::air::inline BRUME_ISA_NS {
//   static void fog(const float* z, float* t, int n) noexcept { ... Batch ... }
//   const RowKernels row_kernels = {fog};
//   }
//
// any other file:
//   static const RowKernels& k = BRUME_ISA_SELECT(row_kernels);
//   k.fog(z, t, n);

#include <string_view>

#define BRUME_ISA_JOIN_(a, b) a##b
#define BRUME_ISA_JOIN(a, b) BRUME_ISA_JOIN_(a, b)
#ifdef BRUME_ISA
#define BRUME_ISA_NS BRUME_ISA_JOIN(isa_, BRUME_ISA)
#else
#define BRUME_ISA_NS isa_host
#endif

/// Declares the table `name` of function pointers in all three instruction sets.
#define BRUME_ISA_DECLARE(Table, name)                              \
  BRUME_ISA_INLINE_V2 namespace isa_v2 { extern const Table name; } \
  BRUME_ISA_INLINE_V3 namespace isa_v3 { extern const Table name; } \
  BRUME_ISA_INLINE_V4 namespace isa_v4 { extern const Table name; }

// `inline` for the one that this file is compiled for, so that what it defines there is
// what is declared here.
#define BRUME_ISA_NUMBER_v2 2
#define BRUME_ISA_NUMBER_v3 3
#define BRUME_ISA_NUMBER_v4 4
#define BRUME_ISA_NUMBER BRUME_ISA_JOIN(BRUME_ISA_NUMBER_, BRUME_ISA)
#if BRUME_ISA_NUMBER == 2
#define BRUME_ISA_INLINE_V2 inline
#elif BRUME_ISA_NUMBER == 3
#define BRUME_ISA_INLINE_V3 inline
#elif BRUME_ISA_NUMBER == 4
#define BRUME_ISA_INLINE_V4 inline
#endif
#ifndef BRUME_ISA_INLINE_V2
#define BRUME_ISA_INLINE_V2
#endif
#ifndef BRUME_ISA_INLINE_V3
#define BRUME_ISA_INLINE_V3
#endif
#ifndef BRUME_ISA_INLINE_V4
#define BRUME_ISA_INLINE_V4
#endif

/// The table `name` of the instruction set in use; in the namespace of its declaration.
#define BRUME_ISA_SELECT(name) \
  ::brume::of_isa(::brume::isa(), isa_v2::name, isa_v3::name, isa_v4::name)

/// For the small functions that kernels are made of: never a call, in any build.
#define BRUME_INLINE [[gnu::always_inline]] inline

namespace brume {

/// x86-64-v2 (SSE4.2, 4 floats), v3 (AVX2 and FMA, 8 floats), v4 (AVX-512, 16 floats).
enum class Isa { v2, v3, v4 };

/// The instruction set in use: the processor's best, or a lower one forced by the
/// environment variable BRUME_ISA = v2, v3 or v4. Chosen at the first call. Throws Error
/// naming the variable when its value is unknown or more than the processor has.
Isa isa();

/// The processor's best. Throws Error when it lacks even v2.
Isa best_isa();

/// "v2", "v3" or "v4" as Isa. Throws Error naming BRUME_ISA for anything else, and for
/// what this processor lacks.
Isa isa_from(std::string_view text);

/// "v2", "v3" or "v4".
const char* name(Isa isa) noexcept;

/// The one of three tables that belongs to `isa`.
template <class Table>
constexpr const Table& of_isa(Isa isa, const Table& v2, const Table& v3,
                              const Table& v4) noexcept {
  return isa == Isa::v4 ? v4 : isa == Isa::v3 ? v3 : v2;
}

}  // namespace brume
