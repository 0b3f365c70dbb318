#pragma once
// A stage that changes pixels on the instruction sets below the processor's best.

#include <memory>
#include <vector>

#include "num/isa.h"
#include "stage/cache.h"
#include "stage/instance.h"
#include "stage/registry.h"

namespace brume::stress {

/// Its module opened again for each, from a copy, as BRUME_ISA would have it run there: a
/// module chooses once. A module that knows nothing of BRUME_ISA gives the same bits.
class LowerIsas {
 public:
  /// Those of a surface or lens stage in a module; of others none (air has the
  /// integrator's). Sets the environment variable while it opens them, so that no other
  /// thread may run. Throws Error where a copy cannot be written.
  explicit LowerIsas(const StageType&);

  struct One {
    Isa isa;
    std::unique_ptr<Registry> registry;
    const StageType* type;
    std::unique_ptr<StageCache> cache;  ///< tables may differ in their last bits
  };
  const std::vector<One>& all() const { return all_; }

 private:
  std::vector<One> all_;
};

}  // namespace brume::stress
