#pragma once
// The functions of light along a ray, each written once as template <class T> for T =
// Batch, float and double: the same formula, and no call into a mathematics library.
//
// Above each stands its contract: formula and source, domain, value at the edges, error
// bound. The tests read the bounds from these comments and hold every instruction set to
// them over the whole domain. What "Bound [f]: float 2, double 2.5 ulp" says:
//   |computed - exact| <= 2 ulp in float (and Batch), 2.5 ulp in double, where an ulp is
//   the spacing of T at the exact value (of denormals where that is smaller); a result
//   that would exceed the largest T may be infinity from one ulp below it on. "Cost" is
//   nanoseconds per value of a Batch, in cache (bench_num; AMD EPYC, Zen 5).
// For every function: total and noexcept; NaN in gives NaN out unless stated; the sign of
// a zero result is not promised; the bounds hold with and without fused multiply-add.

#include "num/math_algebra.h"
#include "num/math_erf.h"
#include "num/math_exp.h"
#include "num/math_log.h"
#include "num/math_trig.h"
