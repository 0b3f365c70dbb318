#pragma once
// Every function of num/math.h over rows of numbers, compiled for each instruction set
// and for the host, so that one test can hold all of them to the bounds in its comment.

#include "num/isa.h"

namespace brume::test {

/// One function (or one of its results), by the name in its "Bound [name]" line. in[k] is
/// the row of its k-th argument; n is a multiple of 16.
struct Function {
  const char* name;
  int inputs;
  void (*batch)(const float* const* in, float* out, int n);
  void (*single)(const float* const* in, float* out, int n);
  void (*twice)(const double* const* in, double* out, int n);
};

struct Functions {
  const Function* begin;
  int size;
};
BRUME_ISA_DECLARE(Functions, functions)
#ifndef BRUME_ISA
inline
#endif
    namespace isa_host {  // and where there is none
extern const Functions functions;
}  // namespace isa_host

}  // namespace brume::test
