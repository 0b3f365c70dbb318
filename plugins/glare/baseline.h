#pragma once
// Glare as the document tells it that the effect comes from: Kallinen 2013 (Reset, in
// Praxis), "FFT of the frame times the FFT of the glare pattern", in float as such code
// is.

#include <vector>

#include "convolve.h"

namespace brume::glare {

/// K * B, width x height floats: whole transforms in float, the frame padded so that
/// nothing comes in on the other side. The pattern's own transform is made each time (the
/// document keeps it: less than half of the time).
std::vector<float> baseline(const Kernel&, int channel, const Bright&, int width,
                            int height);

}  // namespace brume::glare
