#include "run.h"

#include "bind.h"
#include "look.h"

namespace brume::sky::inline BRUME_ISA_NS {

const KernelTable kernel_table = {
    {{kernels_of<float, 4, 2>(), kernels_of<float, 4, 4>(), kernels_of<float, 4, 6>(),
      kernels_of<float, 4, 10>()},
     {kernels_of<float, 8, 2>(), kernels_of<float, 8, 4>(), kernels_of<float, 8, 6>(),
      kernels_of<float, 8, 10>()}}};

const MapKernels map_kernels = {look, through};

}  // namespace brume::sky::inline BRUME_ISA_NS
