#pragma once
// Lens stages: the whole frame at once, after the air. Internal to src/pipeline.

#include "pipeline/impl.h"

namespace brume {

/// Surface and air over `render` (pixels do not depend on the rest of the frame but for
/// Impl::around).
ApplyCounts apply_rows(const PreparedFrame::Impl&, const FrameBuffers&,
                       const Window& render);

/// Everything: surface and air over the whole of buffers.window into planes of its own,
/// the lens stages on those, then `render` of it into the caller's planes.
ApplyCounts apply_with_lens(const PreparedFrame&, const FrameBuffers&,
                            const Window& render);

}  // namespace brume
