#pragma once
// A Batch against its lanes, inside each instruction set.

#include "num/isa.h"

namespace brume::test {

struct BatchCheck {
  int width;
  /// The first operation whose lanes differ from the same operation on floats, or null.
  const char* (*disagreement)(const float* a, const float* b, int n);
};
BRUME_ISA_DECLARE(BatchCheck, batch_check)
#ifndef BRUME_ISA
inline
#endif
    namespace isa_host {  // and where there is none
extern const BatchCheck batch_check;
}  // namespace isa_host

}  // namespace brume::test
